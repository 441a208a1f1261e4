//! Chi-square tests of what lights send: to a point, and as photons.
//!
//! Where samples carry weights, a sample is kept with a probability
//! proportional to its weight: what is kept must follow what the weights are
//! to integrate.

mod common;

use std::f64::consts::TAU;

use common::{
    Estimate,
    cells::{DRAWS, Grid, assert_follows, assert_uniform, height, turn},
    independent, renderer, scene,
};
use glam::DVec3;
use nephroid::{
    geometry::Ray,
    light::{Light, Source},
    numeric::Frame,
    photon::Emission,
    sampling::warp,
};

/// A light of a scene that has no other.
fn light(text: &str) -> Light {
    let scene = scene(&format!(
        "(camera: (eye: (0, 0, 9), look_at: (0, 0, 0), up: (0, 1, 0), fov: 40),
          image: (width: 1, height: 1), objects: [], lights: [{text}])"
    ));
    scene.lights[0].light.clone()
}

/// Asserts that what `sample_direct` samples with its weights is radiance 1
/// over the directions that `sees` accepts, all of which lie within
/// `1 - cos <= q` of `axis`.
fn assert_samples_light(
    light: &Light,
    from: DVec3,
    (axis, q): (DVec3, f64),
    sees: impl Fn(DVec3) -> bool,
    what: &str,
) {
    const N: usize = 12;
    /// Points per cell and side for the cells' visible solid angle.
    const FINE: usize = 64;
    let frame = Frame::around(axis);
    let at = |x: f64, y: f64| {
        let (w, phi) = (q * x, TAU * (y - 0.5));
        let sin = (w * (2.0 - w)).max(0.0).sqrt();
        frame.to_world(DVec3::new(sin * phi.cos(), sin * phi.sin(), 1.0 - w))
    };
    let mut solid = vec![0.0; N * N];
    let side = N * FINE;
    for j in 0..side {
        for i in 0..side {
            let p = [i, j].map(|k| (k as f64 + 0.5) / side as f64);
            if sees(at(p[0], p[1])) {
                solid[Grid::<N>::cell(p)] += TAU * q / (side * side) as f64;
            }
        }
    }
    let samples: Vec<(DVec3, f64, f64)> = (0..DRAWS)
        .filter_map(|i| {
            let mut s = independent(41, i);
            let sample = light.sample_direct(from, s.next_2d())?;
            if let Source::Point(target) = sample.source {
                assert!(sample.wi.dot((target - from).normalize()) > 1.0 - 1e-12);
            }
            Some((sample.wi, sample.weight[1], s.next_1d()))
        })
        .collect();
    // Rounding may put a few just beyond the rim.
    let beside = samples.iter().filter(|s| !sees(s.0)).count();
    assert!(beside < 10, "{what}: {beside} samples miss the light");
    let weights: Vec<f64> = samples.iter().map(|s| s.1).collect();
    let most = weights.iter().copied().fold(0.0, f64::max);
    let grid = Grid::<N>::of(samples.iter().filter(|s| s.2 * most < s.1).map(|(wi, ..)| {
        let d = frame.to_local(*wi);
        // The outermost directions may round beyond the rim.
        [(height(d) / q).min(1.0), turn(d.x, d.y)]
    }));
    assert_follows(&grid.0, &solid, what);
    let estimate = Estimate::of(&weights);
    let total: f64 = solid.iter().sum();
    let mean = estimate.mean * samples.len() as f64 / DRAWS as f64;
    // The rim of the light crosses about a fiftieth of the fine cells and
    // their counts err by a fraction of it.
    assert!(
        (mean - total).abs() <= 5.0 * estimate.error + 2e-3 * total,
        "{what}: weights average to {mean}, the solid angle is {total}"
    );
}

#[test]
fn direct_samples_follow_the_light() {
    let from = DVec3::new(0.3, -0.2, 0.1);
    for (x, r) in [(2.0, 0.5), (1.0, 0.9), (1e4, 0.5)] {
        let center = from + DVec3::new(0.6, 0.0, 0.8) * x;
        let sphere = light(&format!(
            "Sphere(center: ({}, {}, {}), radius: {r}, radiance: 1)",
            center.x, center.y, center.z
        ));
        let q = warp::one_minus_cos(r / x);
        let sees = |d: DVec3| {
            let to = center - from;
            (to - d * to.dot(d)).length() <= r * (1.0 + 1e-9)
        };
        assert_samples_light(&sphere, from, ((center - from) / x, q), sees, "sphere");
    }
    let corner = DVec3::new(0.5, -0.8, 1.0);
    let (u, v) = (DVec3::new(0.0, 1.5, 0.3), DVec3::new(1.1, 0.2, 0.0));
    let quad =
        light("Quad(corner: (0.5, -0.8, 1), u: (0, 1.5, 0.3), v: (1.1, 0.2, 0), radiance: 1)");
    let normal = u.cross(v);
    let toward = (corner + 0.5 * (u + v) - from).normalize();
    let rim = [corner, corner + u, corner + v, corner + u + v];
    let q = rim
        .iter()
        .map(|c| 1.0 - (*c - from).normalize().dot(toward))
        .fold(0.0, f64::max);
    let sees = |d: DVec3| {
        let p = from + d * ((corner - from).dot(normal) / d.dot(normal)) - corner;
        let n2 = normal.length_squared();
        let (a, b) = (p.cross(v).dot(normal) / n2, u.cross(p).dot(normal) / n2);
        d.dot(normal) < 0.0 && (0.0..=1.0).contains(&a) && (0.0..=1.0).contains(&b)
    };
    assert_samples_light(&quad, from, (toward, q), sees, "quad");
    let center = DVec3::new(0.5, 0.5, 0.9);
    let disc =
        light("Disc(center: (0.5, 0.5, 0.9), normal: (-0.5, 0, -1), radius: 0.6, radiance: 1)");
    let normal = DVec3::new(-0.5, 0.0, -1.0).normalize();
    let toward = (center - from).normalize();
    let sees = |d: DVec3| {
        let t = (center - from).dot(normal) / d.dot(normal);
        d.dot(normal) < 0.0 && (from + d * t - center).length() <= 0.6
    };
    // Every point of the disc is within asin(0.6 / distance).
    let q = warp::one_minus_cos(0.6 / (center - from).length());
    assert_samples_light(&disc, from, (toward, q), sees, "disc");
    for diameter in [0.5f64, 100.0] {
        let q = 1.0 - (0.5 * diameter.to_radians()).cos();
        // Radiance 1: irradiance pi sin^2.
        let irradiance = std::f64::consts::PI * (0.5 * diameter.to_radians()).sin().powi(2);
        let sun = light(&format!(
            "Directional(direction: (0, 0.6, -0.8), irradiance: {irradiance}, angular_diameter: {diameter})"
        ));
        let axis = DVec3::new(0.0, -0.6, 0.8);
        assert_samples_light(&sun, from, (axis, q), |_| true, "sun");
    }
}

/// Emissions of a scene's only light. `casters` are its mirrors.
fn emissions(light: &str, casters: &str, family: u64, count: u64) -> Vec<(Emission, f64)> {
    let scene = scene(&format!(
        "(camera: (eye: (0, 0, 9), look_at: (0, 0, 0), up: (0, 1, 0), fov: 40),
          image: (width: 1, height: 1),
          objects: [{casters}
            (shape: Disc(center: (0, 0, -90), normal: (0, 0, 1), radius: 1), material: Diffuse(reflectance: 1))],
          lights: [{light}], render: (photons: 1))"
    ));
    let renderer = renderer(&scene);
    let emitter = renderer.emitter().expect("casters");
    let ctx = renderer.context();
    (0..count)
        .map(|i| {
            let mut stream = independent(family, i);
            let emission = emitter.emit(&ctx, &mut stream);
            stream.seek(40);
            (emission, stream.next_1d())
        })
        .collect()
}

/// Those kept with a probability proportional to their flux.
fn by_flux(emissions: &[(Emission, f64)]) -> impl Iterator<Item = Ray> + '_ {
    let most = emissions.iter().map(|e| e.0.flux[1]).fold(0.0, f64::max);
    emissions
        .iter()
        .filter(move |(e, u)| u * most < e.flux[1])
        .map(|(e, _)| e.ray)
}

/// An unbounded mirror far below: the light's whole domain is used.
const ENDLESS: &str = "(shape: Plane(point: (0, 0, -99), normal: (0, 0, 1)), material: Mirror()),";

#[test]
fn point_like_lights_emit_their_profile() {
    let point = emissions("Point(position: (1, 2, 3), power: 5)", ENDLESS, 51, DRAWS);
    assert!(point.iter().all(|(e, _)| (e.flux[1] - 5.0).abs() < 1e-12));
    assert!(
        point
            .iter()
            .all(|(e, _)| e.ray.origin == DVec3::new(1.0, 2.0, 3.0))
    );
    let direction = |r: Ray| [0.5 * (r.dir.z + 1.0), turn(r.dir.x, r.dir.y)];
    assert_uniform(by_flux(&point).map(direction), "point");
    let spot = emissions(
        "Spot(position: (0, 0, 0), direction: (1, 0, 0), inner: 20, outer: 50, power: 5)",
        ENDLESS,
        52,
        DRAWS,
    );
    let mean = Estimate::of(&spot.iter().map(|(e, _)| e.flux[1]).collect::<Vec<_>>());
    assert!((mean.mean - 5.0).abs() < 5.0 * mean.error, "spot: {mean:?}");
    let (inner, outer) = (20f64.to_radians().cos(), 50f64.to_radians().cos());
    let grid = Grid::<16>::of(
        by_flux(&spot).map(|r| [(1.0 - r.dir.x) / (1.0 - outer), turn(r.dir.y, r.dir.z)]),
    );
    let profile = |x: f64| {
        let cos = 1.0 - x * (1.0 - outer);
        let x = ((cos - outer) / (inner - outer)).clamp(0.0, 1.0);
        x * x * (3.0 - 2.0 * x)
    };
    // The profile's integral over each column by 64 midpoints.
    let column = |i: usize| {
        let at = |k: i32| profile((i as f64 + (f64::from(k) + 0.5) / 64.0) / 16.0);
        (0..64).map(at).sum::<f64>()
    };
    let weights: Vec<f64> = (0..256).map(|c| column(c % 16)).collect();
    assert_follows(&grid.0, &weights, "spot");
}

/// From a ray to its start as a point of the unit square.
type Place<'a> = &'a dyn Fn(Ray) -> [f64; 2];

/// From a ray to the surface normal where it starts.
type Normal<'a> = &'a dyn Fn(Ray) -> DVec3;

/// Glowing shapes: uniform over the area, Lambert's law around the normal, and
/// one has nothing to do with the other.
#[test]
fn shapes_emit_by_lamberts_law() {
    let quad_place = |r: Ray| [(r.origin.x - 1.0) / 2.0, (r.origin.y - 1.0) / 0.5];
    let disc_place = |r: Ray| {
        let p = (r.origin - DVec3::new(0.0, 0.0, 2.0)) / 0.7;
        [p.length_squared(), turn(p.x, p.y)]
    };
    let sphere_normal = |r: Ray| (r.origin - DVec3::new(0.0, 0.0, 5.0)) / 0.3;
    let sphere_place = |r: Ray| {
        let n = sphere_normal(r);
        [0.5 * (n.z + 1.0), turn(n.x, n.y)]
    };
    let up = |_: Ray| DVec3::Z;
    let cases: [(&str, &str, Place<'_>, Normal<'_>); 3] = [
        (
            "quad",
            "Quad(corner: (1, 1, 0), u: (2, 0, 0), v: (0, 0.5, 0), power: 5)",
            &quad_place,
            &up,
        ),
        (
            "disc",
            "Disc(center: (0, 0, 2), normal: (0, 0, 1), radius: 0.7, power: 5)",
            &disc_place,
            &up,
        ),
        (
            "sphere",
            "Sphere(center: (0, 0, 5), radius: 0.3, power: 5)",
            &sphere_place,
            &sphere_normal,
        ),
    ];
    for (name, text, place, normal) in cases {
        let all = emissions(text, ENDLESS, 61, DRAWS);
        for (e, _) in &all {
            assert!((e.flux[1] - 5.0).abs() < 1e-9, "{name}: flux {}", e.flux[1]);
        }
        let lobe = |r: Ray| {
            let d = Frame::around(normal(r)).to_local(r.dir);
            assert!(d.z > 0.0, "{name}: emitted into the body");
            [d.x * d.x + d.y * d.y, turn(d.x, d.y)]
        };
        assert_uniform(by_flux(&all).map(place), &format!("{name}, places"));
        assert_uniform(by_flux(&all).map(lobe), &format!("{name}, directions"));
        assert_uniform(
            by_flux(&all).map(|r| [place(r)[0], lobe(r)[0]]),
            &format!("{name}, joint"),
        );
        assert_uniform(
            by_flux(&all).map(|r| [place(r)[1], lobe(r)[1]]),
            &format!("{name}, turns"),
        );
    }
}

#[test]
fn parallel_light_fills_its_cross_section() {
    let beam = emissions(
        "Directional(direction: (0, 0, -1), irradiance: 2, beam: (center: (1, 2, 3), radius: 0.5))",
        ENDLESS,
        71,
        DRAWS,
    );
    let power = 2.0 * std::f64::consts::PI * 0.25;
    let place = |r: Ray| {
        assert_eq!(r.dir, DVec3::NEG_Z);
        let p = (r.origin - DVec3::new(1.0, 2.0, 3.0)) / 0.5;
        [p.length_squared(), turn(p.x, p.y)]
    };
    assert!(beam.iter().all(|(e, _)| (e.flux[1] - power).abs() < 1e-12));
    assert_uniform(by_flux(&beam).map(place), "beam");
    // A sun of 20 degrees on a mirror ball of radius 2: uniform directions,
    // and for each a uniform cross-section of the ball.
    let ball = "(shape: Sphere(center: (1, 2, 3), radius: 2), material: Mirror()),";
    let sun = emissions(
        "Directional(direction: (0, 0, -1), irradiance: 2, angular_diameter: 20)",
        ball,
        72,
        DRAWS,
    );
    let q = 1.0 - 10f64.to_radians().cos();
    let direction = |r: Ray| [(1.0 + r.dir.z) / q, turn(r.dir.x, r.dir.y)];
    let section = |r: Ray| {
        let f = r.origin - DVec3::new(1.0, 2.0, 3.0);
        let across = Frame::around(r.dir).to_local(f);
        let radius2 = (across.x * across.x + across.y * across.y) / 4.0;
        [radius2.min(1.0), turn(across.x, across.y)]
    };
    assert_uniform(by_flux(&sun).map(direction), "sun, directions");
    assert_uniform(by_flux(&sun).map(section), "sun, places");
    assert_uniform(
        by_flux(&sun).map(|r| [direction(r)[0], section(r)[0]]),
        "sun, joint",
    );
}

/// Where a ray enters a ball, as a point of the unit square.
fn entry(ray: Ray, center: DVec3, radius: f64) -> Option<[f64; 2]> {
    let to = center - ray.origin;
    let along = to.dot(ray.dir);
    let across2 = to.length_squared() - along * along;
    (along > 0.0 && across2 < radius * radius).then(|| {
        let t = along - (radius * radius - across2).sqrt();
        let n = (ray.at(t) - center) / radius;
        [0.5 * (n.z + 1.0), turn(n.x, n.y)]
    })
}

/// Aiming changes nothing but the number of photons that miss: light aimed at
/// two overlapping balls enters one of them as light that is sent everywhere.
#[test]
fn aimed_light_is_the_light_that_arrives() {
    let balls = "(shape: Sphere(center: (0, 0, -1), radius: 0.8), material: Mirror()),
         (shape: Sphere(center: (0.7, 0, -1.2), radius: 0.5), material: Mirror()),";
    let (center, radius) = (DVec3::new(0.0, 0.0, -1.0), 0.8);
    for text in [
        "Point(position: (0.3, 0.2, 1), power: 5)",
        "Spot(position: (0.3, 0.2, 1), look_at: (0.5, 0, -1), inner: 5, outer: 25, power: 5)",
        "Sphere(center: (-0.5, 0.2, 1), radius: 0.6, power: 5)",
        "Quad(corner: (-1, -1, 0.5), u: (0, 2, 0), v: (2, 0, 0.3), power: 5)",
        "Disc(center: (0, 1, 0), normal: (0, -0.3, -1), radius: 0.8, power: 5)",
        "Directional(direction: (0.3, 0, -1), irradiance: 2, beam: (center: (0, 0, 1), radius: 1.2))",
    ] {
        let cell = |ray: Ray| {
            let side = usize::from(ray.origin.x > ray.origin.y);
            entry(ray, center, radius).map(|p| 2 * Grid::<10>::cell(p) + side)
        };
        let count = |emissions: &[(Emission, f64)]| {
            let mut counts = vec![0u64; 200];
            for ray in by_flux(emissions) {
                if let Some(c) = cell(ray) {
                    counts[c] += 1;
                }
            }
            counts
        };
        let aimed = emissions(text, balls, 81, DRAWS);
        let everywhere = emissions(text, ENDLESS, 82, 50 * DRAWS);
        // A cell that the reference missed is rare, not impossible.
        let weights: Vec<f64> = count(&everywhere)
            .iter()
            .map(|c| (*c as f64).max(0.5))
            .collect();
        assert_follows(&count(&aimed), &weights, text);
        let arriving = |emissions: &[(Emission, f64)]| {
            let flux =
                |(e, _): &(Emission, f64)| entry(e.ray, center, radius).map_or(0.0, |_| e.flux[1]);
            Estimate::of(&emissions.iter().map(flux).collect::<Vec<_>>())
        };
        let (a, b) = (arriving(&aimed), arriving(&everywhere));
        assert!(
            (a.mean - b.mean).abs() < 5.0 * a.error.hypot(b.error),
            "{text}: {a:?} W arrive, {b:?} W should"
        );
    }
}
