//! Derivatives of light paths against finite differences, over all shapes and
//! specular materials.

use std::collections::BTreeMap;

use glam::{DVec2, DVec3};
use nephroid::{
    geometry::{Ray, SurfaceId},
    plan::{Media, Plan},
    sampling::{Purpose, Sequence, Stream, warp},
    scene,
    transport::{
        Bend, Carried, Context, Differential, LightPicker, Lobes, Pair, lobes, media_beside, meet,
    },
};

/// Every shape, in glass and in metal, some of them sheared or mirrored, some
/// smooth and some faceted, in a ring around the origin.
const SCENE: &str = r#"(
    camera: (eye: (0, 0, 0), look_at: (1, 0, 0), fov: 40),
    image: (width: 8, height: 8),
    materials: {
        "glass": Dielectric(ior: 1.5),
        "pane": Dielectric(ior: 1.5, thin: true),
        "metal": Mirror(reflectance: 0.9),
        "white": Diffuse(reflectance: 0.5),
    },
    objects: [
        (name: "room", shape: Sphere(center: (0, 0, 0), radius: 20), material: "white"),
        (name: "ball", shape: Sphere(center: (4, 0, 0), radius: 1.2), material: "glass"),
        (name: "egg", shape: Sphere(center: (0, 0, 0), radius: 1), material: "glass",
            at: (scale: (1.5, 0.7, -1), rotate: (axis: (1, 2, 3), degrees: 40), translate: (2.5, 3, 0))),
        (name: "can", shape: Cylinder(base: (-0.5, 4, -1), end: (0.5, 4.5, 1), radius: 0.9, capped: true), material: "glass"),
        (name: "tube", shape: Cylinder(base: (0, 0, -1), end: (0, 0, 1), radius: 1), material: "metal",
            at: (scale: (1, 0.6, 1.2), translate: (-3, 3, 0))),
        (name: "pearl", shape: Sphere(center: (-4, 0, 0), radius: 1), material: "metal"),
        (name: "knot", shape: TorusKnot(segments: 256, sides: 48, tube: 0.3), material: "glass",
            at: (scale: 1, translate: (-3, -3, 0))),
        (name: "waves", shape: Waves(x: (-2, 2), y: (-2, 2), cells: 64, waves: [(amplitude: 0.03, k: (4, 2)), (amplitude: 0.02, k: (-3, 5), phase: 1)]), material: "metal", at: (rotate: (axis: (1, 0, 0), degrees: 90), translate: (0, -4, 0))),
        (name: "window", shape: Quad(corner: (2, -4, -1), u: (1.5, 1, 0), v: (0, 0, 2)), material: "pane"),
        (name: "looking-glass", shape: Disc(center: (0, 0, 4), radius: 2, normal: (0.2, 0.1, -1)), material: "metal"),
        (name: "ground", shape: Plane(point: (0, 0, -5), normal: (0, 0.1, 1)), material: "glass", open: true),
        (name: "gem", shape: Mesh(
            vertices: [(1, 0, 0), (-1, 0, 0), (0, 1, 0), (0, -1, 0), (0, 0, 1), (0, 0, -1)],
            triangles: [(0, 2, 4), (2, 1, 4), (1, 3, 4), (3, 0, 4), (2, 0, 5), (1, 2, 5), (3, 1, 5), (0, 3, 5)],
        ), material: "glass", at: (scale: (1, 1.2, 1.4), translate: (3, -2, 2))),
        // Oil that reaches into the ball, a bubble in both, and what is hidden in the bubble.
        (name: "oil", shape: Sphere(center: (3.2, 0.6, 0.5), radius: 0.9), material: Dielectric(ior: 1.4, priority: -1)),
        (name: "bubble", shape: Sphere(center: (3.4, 0.3, 0.2), radius: 0.7), material: Dielectric(ior: 1, priority: 1)),
        (name: "hidden", shape: Sphere(center: (3.4, 0.3, 0.2), radius: 0.4), material: Dielectric(ior: 2)),
        (name: "cone", shape: Cone(base: (0, 5, 2), end: (0.2, 5.2, 4), radius: 1.2, top_radius: 0.4, capped: true), material: "glass"),
        (name: "dish", shape: Paraboloid(base: (3, 3, 3), apex: (4, 4, 4), radius: 1.2), material: "metal"),
        (name: "tower", shape: Hyperboloid(base: (4, 4, -4), end: (4, 4, -1.5), radius: 1, waist: 0.6, end_radius: 0.8, capped: true), material: "glass"),
        (name: "pebble", shape: Ellipsoid(center: (-4, 0, 3), semi_axes: (1.4, 1, 0.7), rotate: (axis: (1, 2, 3), degrees: 40)), material: "glass"),
        (name: "ring", shape: Torus(center: (-4, -1, -3), axis: (1, 0.4, 0.8), major: 1, minor: 0.45), material: "glass"),
        (name: "block", shape: Box(center: (0, 4.5, -3), size: (1.6, 1.4, 1.2)), material: "glass", at: (rotate: (axis: (0, 0, 1), degrees: 10))),
        (name: "saddle", shape: Quadric(coefficients: (0.3, -0.2, 0, 0.1, 0, 0, -0.6, 0.4, -1, 4.5), bounds: ((-3, -5, 1), (-0.5, -2.5, 6))), material: "metal"),
        (name: "lens", shape: Lens(r1: 1.5, r2: -2, thickness: 0.6, aperture: 1.6), material: "glass",
            at: (rotate: (axis: (0, 1, 0.2), degrees: 60), translate: (3.5, 0, -3))),
        (name: "die", shape: Difference(of: [
            (shape: Box(center: (0, 0, 0), size: (1.6, 1.6, 1.6))),
            (shape: Sphere(center: (0.9, 0, 0), radius: 0.6)),
            (shape: Sphere(center: (0, -0.9, 0), radius: 0.6)),
         ]), material: "glass", at: (rotate: (axis: (1, 1, 0), degrees: 200), translate: (-3.5, 2, -3))),
    ],
    lights: [Point(position: (0, 0, 0), power: 1)],
)"#;

/// A bundle of rays by two coordinates, and how far to go with which lobes.
struct Bundle {
    origin: DVec3,
    dir: DVec3,
    pair: Pair,
    /// Which of two lobes is followed, by depth.
    second: [bool; 5],
}

/// Where a ray of the bundle has come to.
struct Path {
    surfaces: Vec<SurfaceId>,
    kinds: Vec<u8>,
    p: DVec3,
    dir: DVec3,
    pair: Pair,
}

fn any(s: &mut Stream, size: f64) -> DVec3 {
    warp::sphere(s.next_2d()) * (size * s.next_1d())
}

impl Bundle {
    /// Towards anything, or into the bodies that lie in each other.
    fn draw(s: &mut Stream, nested: bool) -> Self {
        let origin = any(s, 2.0);
        let mut dir = warp::sphere(s.next_2d()).normalize();
        if nested {
            dir = (DVec3::new(3.4, 0.3, 0.2) + dir * 0.6 - origin).normalize();
        }
        let across = |v: DVec3| v - dir * v.dot(dir);
        let pair = Pair {
            dp: [any(s, 1.0), any(s, 1.0)].into(),
            dd: [across(any(s, 1.0)), across(any(s, 1.0))].into(),
        };
        let second = [0; 5].map(|_| s.next_1d() < 0.6);
        Self {
            origin,
            dir,
            pair,
            second,
        }
    }

    /// Follows the ray that lies `u` beside the bundle's own, to the last
    /// surface before it is scattered for the sixth time.
    fn follow(&self, ctx: &Context<'_>, u: [f64; 2]) -> Option<Path> {
        let [dp, dd] = [self.pair.dp, self.pair.dd].map(|v| {
            let [a, b] = v.to_array();
            a * u[0] + b * u[1]
        });
        let mut ray = Ray::new(self.origin + dp, (self.dir + dd).normalize());
        let mut media = Media::NONE;
        let mut differential = Differential::new();
        differential.push(self.pair, DVec2::INFINITY);
        let (mut surfaces, mut kinds) = (Vec::new(), Vec::new());
        for second in self.second {
            let met = meet(ctx, &ray, f64::INFINITY, &mut media)?;
            let (hit, point) = (met.hit, met.point);
            differential.transfer(ray.dir, hit.t, point.ng);
            surfaces.push(hit.surface);
            let lobe = match lobes(&met.material, &point, ray.dir, Carried::Flux) {
                Some(Lobes::Two(_, b)) if second => b,
                Some(Lobes::One(a) | Lobes::Two(a, _)) => a,
                None => {
                    return Some(Path {
                        surfaces,
                        kinds,
                        p: point.p,
                        dir: ray.dir,
                        pair: differential.pairs()[0],
                    });
                }
            };
            kinds.push(match lobe.bend {
                Bend::Straight => 0,
                Bend::Mirror { .. } => 1,
                Bend::Refract { .. } => 2,
            });
            let turning = ctx.scene.world.turning(&hit, &point);
            differential.bend(ray.dir, &lobe.bend, &turning);
            media = media_beside(ctx, media, &point, lobe.dir);
            ray = point.spawn(lobe.dir);
        }
        None
    }
}

/// Central differences of what a path ends with; `None` where neighbours take
/// another way.
fn differences(ctx: &Context<'_>, bundle: &Bundle, path: &Path, h: f64) -> Option<[[DVec3; 2]; 2]> {
    let mut out = [[DVec3::ZERO; 2]; 2];
    for k in 0..2 {
        let mut u = [0.0; 2];
        u[k] = h;
        let [a, b] = [u, u.map(|x| -x)].map(|u| bundle.follow(ctx, u));
        let (a, b) = (a?, b?);
        for side in [&a, &b] {
            if side.surfaces != path.surfaces || side.kinds != path.kinds {
                return None;
            }
        }
        out[0][k] = (a.p - b.p) / (2.0 * h);
        out[1][k] = (a.dir - b.dir) / (2.0 * h);
    }
    Some(out)
}

#[test]
fn derivatives_follow_every_chain_of_surfaces() {
    let scene = scene::load_str(SCENE, "ring.ron", ".".as_ref()).expect("a sound scene");
    let plan = Plan::new(&scene, &scene.settings);
    let ctx = Context {
        scene: &scene,
        plan: &plan,
        picker: &LightPicker::new(&scene),
        max_depth: scene.settings.max_depth,
    };
    let (mut tested, mut doubtful) = (0, 0);
    let mut met = BTreeMap::<(u32, u8), u32>::new();
    for i in 0..7000 {
        let mut s = Sequence::new(4, Purpose::Pilot, 0, i).at(0);
        let bundle = Bundle::draw(&mut s, i >= 6000);
        let Some(path) = bundle.follow(&ctx, [0.0; 2]) else {
            continue;
        };
        let [coarse, fine] = [4e-6, 1e-6].map(|h| differences(&ctx, &bundle, &path, h));
        let (Some(coarse), Some(fine)) = (coarse, fine) else {
            continue;
        };
        for (k, exact) in [path.pair.dp, path.pair.dd].into_iter().enumerate() {
            let exact = exact.to_array();
            let size = exact[0].length().max(exact[1].length()).max(1.0);
            for axis in 0..2 {
                // Where two steps disagree, the difference tells nothing.
                if coarse[k][axis].distance(fine[k][axis]) > 1e-5 * size {
                    doubtful += 1;
                    continue;
                }
                let error = exact[axis].distance(fine[k][axis]);
                assert!(
                    error < 1e-4 * size,
                    "bundle {i}, {}: {} against {} after {:?} {:?}",
                    ["place", "direction"][k],
                    exact[axis],
                    fine[k][axis],
                    path.surfaces,
                    path.kinds
                );
                tested += 1;
            }
        }
        for (surface, kind) in path.surfaces.iter().zip(&path.kinds) {
            *met.entry((surface.instance, *kind)).or_default() += 1;
        }
    }
    assert!(
        tested > 8000 && doubtful * 5 < tested,
        "{tested} tested, {doubtful} in doubt"
    );
    // Each glass body reflects and refracts, each metal one reflects.
    for (name, kinds) in [
        (1, &[1, 2][..]),
        (2, &[1, 2]),
        (3, &[1, 2]),
        (4, &[1]),
        (5, &[1]),
        (6, &[1, 2]),
        (7, &[1]),
        (8, &[0, 1]),
        (9, &[1]),
        (10, &[1, 2]),
        (11, &[1, 2]),
        (12, &[1, 2]),
        (13, &[1, 2]),
        (15, &[1, 2]),
        (16, &[1]),
        (17, &[1, 2]),
        (18, &[1, 2]),
        (19, &[1, 2]),
        (20, &[1, 2]),
        (21, &[1]),
        (22, &[1, 2]),
        (23, &[1, 2]),
    ] {
        for kind in kinds {
            let count = met.get(&(name, *kind)).copied().unwrap_or(0);
            assert!(count >= 10, "object {name}, kind {kind}: met {count} times");
        }
    }
    assert!(
        !met.keys().any(|&(instance, _)| instance == 14),
        "what is hidden is never met"
    );
}
