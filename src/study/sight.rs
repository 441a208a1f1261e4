//! Which light each way sees, layer by layer.

use crate::{
    film::Layer,
    light::Light,
    plan::Plan,
    reference::Method,
    scene::{Scene, Settings},
};

use super::request::Way;

/// The layers of a picture that something sees wholly, in the order of
/// [`Layer::ALL`].
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub(super) struct Sight(Vec<Layer>);

impl Sight {
    /// Everything.
    pub(super) fn whole() -> Self {
        Self(Layer::ALL.to_vec())
    }

    fn only(layers: &[Layer]) -> Self {
        let seen = |l: &Layer| layers.contains(l);
        Self(Layer::ALL.into_iter().filter(seen).collect())
    }

    /// What both see.
    pub(super) fn and(&self, other: &Self) -> Self {
        let seen = self.0.iter().copied().filter(|l| other.0.contains(l));
        Self(seen.collect())
    }

    /// The layers.
    pub(super) fn layers(&self) -> &[Layer] {
        &self.0
    }

    /// Whether nothing is missing.
    pub(super) fn is_whole(&self) -> bool {
        self.0.len() == Layer::ALL.len()
    }

    /// Whether there is light that a method can be judged by. The lights
    /// themselves are none: every method sees them without effort.
    pub(super) fn is_worth_judging(&self) -> bool {
        self.0.iter().any(|&l| l != Layer::Emission)
    }

    /// Names of the layers; none if nothing is missing.
    pub(super) fn names(&self) -> Vec<String> {
        if self.is_whole() {
            return Vec::new();
        }
        self.0.iter().map(|l| l.name().to_owned()).collect()
    }
}

/// What of the scene the way does not see, in sentences without its name.
pub(super) fn blind_spots(way: Way, scene: &Scene) -> Vec<String> {
    match way {
        Way::Photons => Vec::new(),
        Way::Reference(method) => {
            let prefix = format!("method {}: ", method.name());
            let strip = |text: String| text.strip_prefix(&prefix).unwrap_or(&text).to_owned();
            method.blind_spots(scene).into_iter().map(strip).collect()
        }
    }
}

/// The layers that the way sees wholly in a render with these settings. A
/// method with blind spots of which it is not known that they leave a layer
/// whole sees nothing.
pub(super) fn sight(way: Way, scene: &Scene, settings: &Settings) -> Sight {
    let Way::Reference(method) = way else {
        return Sight::whole();
    };
    if method.blind_spots(scene).is_empty() {
        return Sight::whole();
    }
    let plan = Plan::new(scene, settings);
    let is_sun = |l: &Light| matches!(l, Light::Sun(_));
    let has_sun = scene.lights.iter().any(|l| is_sun(&l.light));
    let has_extent = scene.lights.iter().any(|l| l.light.has_extent());
    let bends = |o: &crate::scene::Object| o.material.is_specular() && !o.material.is_straight();
    let is_any = |methods: &[Method]| methods.contains(&method);
    if is_any(&[Method::PhotonMap, Method::Sppm]) && !has_sun {
        // They blur what they see, which is an error to be measured.
        return Sight::whole();
    }
    let mut seen = Vec::new();
    if is_any(&[Method::Path]) || (is_any(&[Method::Whitted]) && !has_extent) {
        // Light that fell on a diffuse surface in a caustic is missing from
        // all that it lights.
        seen.extend([Layer::Direct, Layer::Emission]);
    } else if is_any(&[Method::Bdpt, Method::Metropolis]) {
        // A caustic in a mirror is one that no light path can be joined to;
        // what it lights can be.
        seen.extend([Layer::Direct, Layer::Indirect, Layer::Emission]);
    } else if is_any(&[Method::Light]) && !has_sun && !scene.objects.iter().any(bends) {
        seen.extend([Layer::Direct, Layer::Caustic, Layer::Indirect]);
    }
    // What is not there nobody misses.
    if !seen.is_empty() {
        if !plan.indirect {
            seen.push(Layer::Indirect);
        }
        if !plan.caustics {
            seen.push(Layer::Caustic);
        }
        if !has_extent {
            seen.push(Layer::Emission);
        }
    }
    Sight::only(&seen)
}

/// The reference methods that may tell the truth about a scene, with the layers
/// that they see: first those that see everything. Methods whose errors on
/// purpose never vanish are not among them.
pub(super) fn witnesses(scene: &Scene, settings: &Settings) -> Vec<(Method, Sight)> {
    let [first, second] = if Plan::new(scene, settings).caustics {
        [Method::Bdpt, Method::Path]
    } else {
        [Method::Path, Method::Bdpt]
    };
    let candidates = [
        first,
        second,
        Method::Light,
        Method::Metropolis,
        Method::Sppm,
    ];
    let mut witnesses: Vec<(Method, Sight)> = candidates
        .into_iter()
        .map(|method| (method, sight(Way::Reference(method), scene, settings)))
        .filter(|(_, sight)| sight.is_worth_judging())
        .collect();
    // Stable: the order within the same number of layers stays.
    witnesses.sort_by_key(|(_, sight)| Layer::ALL.len() - sight.layers().len());
    witnesses
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use super::*;
    use crate::scene::load_str;

    fn scene(light: &str, object: &str) -> Scene {
        let text = format!(
            "(camera: (eye: (0, -3, 1), look_at: (0, 0, 0), fov: 40), image: (width: 8, height: 8),
              materials: {{\"white\": Diffuse(reflectance: 0.5), \"glass\": Dielectric(ior: 1.5)}},
              objects: [(shape: Plane(point: (0, 0, 0), normal: (0, 0, 1)), material: \"white\"), {object}],
              lights: [{light}])"
        );
        load_str(&text, "test.ron", Path::new("")).unwrap_or_else(|e| panic!("{e}"))
    }

    const BALL: &str = "(shape: Sphere(center: (0, 0, 1), radius: 0.5), material: \"glass\")";
    const POINT: &str = "Point(position: (0, 0, 3), power: 1)";
    const LAMP: &str = "Sphere(center: (0, 0, 3), radius: 0.1, radiance: 1)";

    fn layers(method: Method, scene: &Scene) -> Vec<Layer> {
        let sight = sight(Way::Reference(method), scene, &scene.settings);
        sight.layers().to_vec()
    }

    #[test]
    fn who_sees_what() {
        use Layer::{Caustic, Direct, Emission, Indirect};
        let all = Layer::ALL.to_vec();
        let lamp = scene(LAMP, BALL);
        assert_eq!(layers(Method::Path, &lamp), all);
        assert_eq!(layers(Method::Bdpt, &lamp), all);
        assert_eq!(layers(Method::Light, &lamp), [], "glass looks black");
        assert_eq!(layers(Method::LightNaive, &lamp), [], "blurred");
        assert_eq!(layers(Method::Sppm, &lamp), all, "its blur is its error");
        assert_eq!(layers(Method::Radiosity, &lamp), [], "no glass");
        assert_eq!(layers(Method::Whitted, &lamp), [], "hard shadows");
        let point = scene(POINT, BALL);
        assert_eq!(layers(Method::Path, &point), [Direct, Emission]);
        assert_eq!(layers(Method::Bdpt, &point), [Direct, Indirect, Emission]);
        assert_eq!(layers(Method::Whitted, &point), [Direct, Emission]);
        let bare = scene(POINT, "");
        assert_eq!(layers(Method::Path, &bare), all);
        assert_eq!(layers(Method::Light, &bare), all);
        // Nothing that a lone plane could light.
        assert_eq!(layers(Method::Whitted, &bare), all);
        let both = Sight::only(&[Direct, Indirect]).and(&Sight::only(&[Indirect, Caustic]));
        assert_eq!(both.layers(), [Indirect]);
        assert_eq!(both.names(), ["indirect"]);
        assert!(Sight::whole().names().is_empty());
    }

    #[test]
    fn the_best_witness_comes_first() {
        let first = |scene: &Scene| witnesses(scene, &scene.settings)[0].clone();
        let (method, sight) = first(&scene(LAMP, BALL));
        assert_eq!(method, Method::Bdpt);
        assert!(sight.is_whole());
        assert_eq!(first(&scene(LAMP, "")).0, Method::Path);
        let all = witnesses(&scene(LAMP, BALL), &Settings::default());
        assert!(all.iter().all(|(m, _)| *m != Method::Whitted));
    }
}
