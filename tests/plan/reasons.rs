//! A scene for each reason why a caustic is missing.

use nephroid::{
    plan::{Plan, judge},
    scene::{Effect, Scene},
    survey::{Funnel, Survey},
};

use crate::common::scene_of;

/// Where a caustic is lost, and a part of what is said about it.
pub(crate) struct Missing {
    pub(crate) name: &'static str,
    objects: &'static str,
    lights: &'static str,
    render: &'static str,
    /// Whether it is proved before any sample.
    proved: bool,
    said: &'static str,
}

const FLOOR: &str =
    "(name: \"floor\", shape: Plane(point: (0, 0, 0), normal: (0, 0, 1)), material: \"grey\"),";
const BALL: &str =
    "(name: \"ball\", shape: Sphere(center: (0, 0, 1), radius: 0.5), material: \"glass\"),";

const fn missing(
    name: &'static str,
    objects: &'static str,
    lights: &'static str,
    proved: bool,
    said: &'static str,
) -> Missing {
    Missing {
        name,
        objects,
        lights,
        render: "",
        proved,
        said,
    }
}

pub(crate) const ALL: &[Missing] = &[
    missing(
        "mirrors alone",
        "(name: \"ball\", shape: Sphere(center: (0, 0, 1), radius: 0.5), material: \"mirror\")",
        "Point(name: \"lamp\", position: (0, 0, 4), power: 10)",
        true,
        "no surface is diffuse: nothing can receive a caustic",
    ),
    missing(
        "a spot that looks elsewhere",
        "FLOOR BALL",
        "Spot(name: \"lamp\", position: (4, 0, 4), look_at: (4, 0, 0), inner: 0, outer: 20, power: 10)",
        true,
        "`ball` lies outside of the cone of `lamp`",
    ),
    missing(
        "a disc that faces away",
        "FLOOR BALL",
        "Disc(name: \"lamp\", center: (0, 0, 4), radius: 0.2, normal: (0, 0, 1), power: 10)",
        true,
        "`ball` lies behind the face of `lamp` that shines",
    ),
    missing(
        "a beam beside the ball",
        "FLOOR BALL",
        "Directional(name: \"lamp\", direction: (0, 0, -1), irradiance: 10,
                     beam: (center: (2, 0, 4), radius: 1))",
        true,
        "the beam of `lamp` passes `ball` by",
    ),
    missing(
        "a lamp below the floor",
        "FLOOR BALL",
        "Sphere(name: \"lamp\", center: (0, 0, -2), radius: 0.2, power: 10)",
        true,
        "`floor` stands between `lamp` and `ball`",
    ),
    missing(
        "the sun below the floor",
        "FLOOR BALL",
        "Directional(name: \"lamp\", direction: (0.1, 0, 1), irradiance: 10, angular_diameter: 0.5)",
        true,
        "`floor` stands between `lamp` and `ball`",
    ),
    missing(
        "a ball in a box",
        "FLOOR BALL (name: \"box\", shape: Box(min: (-1, -1, 0.2), max: (1, 1, 2)), material: \"white\")",
        "Point(name: \"lamp\", position: (0, 0, 4), power: 10)",
        true,
        "`box` stands between `lamp` and `ball`",
    ),
    missing(
        "a lamp in a shell",
        "FLOOR BALL (name: \"shell\", shape: Sphere(center: (0, 0, 4), radius: 1), material: \"white\")",
        "Sphere(name: \"lamp\", center: (0, 0, 4), radius: 0.2, power: 10)",
        true,
        "`shell` stands between `lamp` and `ball`",
    ),
    missing(
        "lamp and ball in a mirror",
        "FLOOR BALL (name: \"shell\", shape: Sphere(center: (0, 0, 1.5), radius: 1.2), material: \"mirror\")",
        "Point(name: \"lamp\", position: (0, 0, 2.2), power: 10)",
        true,
        "`shell` keeps `lamp` from all diffuse surfaces",
    ),
    missing(
        "a board in the way",
        "FLOOR BALL (name: \"board\", shape: Quad(corner: (-3, -3, 3), u: (6, 0, 0), v: (0, 6, 0)), material: \"white\")",
        "Point(name: \"lamp\", position: (0, 0, 4), power: 10)",
        false,
        "`board` stands between `lamp` and `ball`: none of",
    ),
    missing(
        "a lamp in a bulb",
        "(name: \"bulb\", shape: Sphere(center: (0, 0, 1), radius: 0.5), material: \"glass\"),
         (name: \"moon\", shape: Sphere(center: (0, 0, 100000), radius: 1), material: \"white\")",
        "Point(name: \"lamp\", position: (0, 0, 1), power: 10)",
        false,
        "`bulb` encloses `lamp`, and nothing diffuse lies where its light goes",
    ),
    missing(
        "nothing below",
        "BALL (name: \"moon\", shape: Sphere(center: (0, 0, 100000), radius: 1), material: \"white\")",
        "Point(name: \"lamp\", position: (0, 0, 4), power: 10)",
        false,
        "nothing diffuse lies where `ball` throws the light of `lamp`",
    ),
    missing(
        "a sheet of water upside down",
        "(name: \"sheet\", shape: Quad(corner: (-1, -1, 1), u: (0, 2, 0), v: (2, 0, 0)), material: \"glass\", open: true),
         (name: \"moon\", shape: Sphere(center: (0, 0, 100000), radius: 1), material: \"white\")",
        "Point(name: \"lamp\", position: (0, 0, 4), power: 10)",
        false,
        "`sheet` meets the light of `lamp` with its back",
    ),
    missing(
        "a mirror that shows the lamp itself",
        "(name: \"ball\", shape: Disc(center: (0, 0, 0), radius: 0.3, normal: (0, 0, 1)), material: \"mirror\"),
         (name: \"moon\", shape: Sphere(center: (0, 0, 100000), radius: 1), material: \"white\")",
        "Sphere(name: \"lamp\", center: (0, 0, 6), radius: 5, power: 10)",
        false,
        "all that `ball` throws is absorbed",
    ),
    Missing {
        name: "a shallow limit",
        objects: "FLOOR BALL (name: \"core\", shape: Sphere(center: (0, 0, 1), radius: 0.2), material: Dielectric(ior: 2, priority: 1))",
        lights: "Point(name: \"lamp\", position: (0, 0, 1), power: 10)",
        render: "max_depth: 1",
        proved: false,
        said: "the depth limit 1 is reached by 100 % of the photons: raise it to",
    },
    Missing {
        name: "caustics off",
        objects: "FLOOR BALL",
        lights: "Point(name: \"lamp\", position: (0, 0, 4), power: 10)",
        render: "effects: (caustics: Off)",
        proved: false,
        said: "caustics are switched off",
    },
    missing(
        "behind the camera",
        "FLOOR (name: \"ball\", shape: Sphere(center: (0, -200, 1), radius: 0.5), material: \"glass\")",
        "Spot(name: \"lamp\", position: (0, -200, 4), look_at: (0, -200, 0), inner: 0, outer: 20, power: 10)",
        false,
        "fell where the camera looks",
    ),
];

impl Missing {
    pub(crate) fn scene(&self) -> Scene {
        let objects = self.objects.replace("FLOOR", FLOOR).replace("BALL", BALL);
        scene_of(
            "eye: (0, -6, 3), look_at: (0, 0, 0.5), fov: 40",
            [32, 24],
            &objects,
            self.lights,
            self.render,
        )
    }
}

#[test]
fn every_missing_caustic_has_its_reason() {
    for missing in ALL {
        let scene = missing.scene();
        let name = missing.name;
        let survey = Survey::of(&scene, &scene.settings, scene.resolution);
        let said = |f: &&Funnel| f.reason.as_ref().is_some_and(|r| r.contains(missing.said));
        let funnel = survey.funnels.iter().find(said);
        let funnel = funnel
            .unwrap_or_else(|| panic!("{name}: {:?} is not in {:?}", missing.said, survey.funnels));
        assert!(
            funnel.aimed >= funnel.met && funnel.met >= funnel.landed,
            "{name}"
        );
        let plan = Plan::new(&scene, &scene.settings);
        if missing.proved {
            assert!(!plan.caustics, "{name}: photons are traced in vain");
            assert_eq!(funnel.aimed, 0, "{name}");
            let verdicts = judge(&scene, &scene.settings);
            let of = verdicts.iter().find(|v| v.effect == Effect::Caustics);
            let of = of.expect("a verdict");
            assert!(
                !of.on && of.why.contains(missing.said),
                "{name}: {}",
                of.why
            );
        } else if !missing.render.contains("caustics") {
            assert!(plan.caustics, "{name}: a sample has switched an effect off");
        }
    }
}

/// The same pairs with what hid them taken away: a proof that always holds
/// would prove nothing.
#[test]
fn a_caustic_that_is_there_is_not_explained_away() {
    for (objects, lights) in [
        (
            "FLOOR BALL",
            "Spot(name: \"lamp\", position: (4, 0, 4), look_at: (0, 0, 1), inner: 0, outer: 20, power: 10)",
        ),
        (
            "FLOOR BALL",
            "Disc(name: \"lamp\", center: (0, 0, 4), radius: 0.2, normal: (0, 0, -1), power: 10)",
        ),
        (
            "FLOOR BALL",
            "Directional(name: \"lamp\", direction: (0, 0, -1), irradiance: 10, beam: (center: (0.4, 0, 4), radius: 0.3))",
        ),
        (
            "FLOOR BALL (name: \"box\", shape: Box(min: (-1, -1, 0.2), max: (1, 1, 5)), material: \"white\")",
            "Sphere(name: \"lamp\", center: (0, 0, 4), radius: 0.2, power: 10)",
        ),
        (
            "FLOOR BALL (name: \"tube\", shape: Cylinder(base: (0, 0, 0.1), end: (0, 0, 3), radius: 1, capped: false), material: \"white\")",
            "Point(name: \"lamp\", position: (0, 0, 4), power: 10)",
        ),
    ] {
        let objects = objects.replace("FLOOR", FLOOR).replace("BALL", BALL);
        let scene = scene_of(
            "eye: (0, -6, 3), look_at: (0, 0, 0.5), fov: 40",
            [32, 24],
            &objects,
            lights,
            "",
        );
        assert!(Plan::new(&scene, &scene.settings).caustics, "{lights}");
        let survey = Survey::of(&scene, &scene.settings, scene.resolution);
        let funnel = survey
            .funnels
            .iter()
            .find(|f| f.object == "ball")
            .expect("a funnel");
        assert!(funnel.landed > 0, "{lights}: {funnel:?}");
    }
}
