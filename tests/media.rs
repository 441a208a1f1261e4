//! Bodies of clear media in each other, against Snell's law at every
//! interface, formulas for lenses, and the same scenes with every interface
//! written out.

mod common;

use common::{Estimate, assert_close, photon_paths, reflectance, render, scene_of};
use glam::DVec3;
use nephroid::{
    geometry::Ray,
    photon::Photon,
    plan::{Media, Plan},
    sampling::{Purpose, Sequence, Stream, warp},
    scene::Scene,
    transport::{
        Bend, Carried, Context, End, LightPicker, Lobes, Walker, lobes, media_beside, meet,
        transmittance,
    },
};

const CAMERA: &str = "eye: (0, -9, 3), look_at: (0, 0, 0), fov: 30";
const LAMP: &str = "Point(position: (0, 0, 8), power: 100)";

/// A sphere as it stands in a scene.
fn ball(center: [f64; 3], radius: f64, material: &str) -> String {
    let [x, y, z] = center;
    format!(
        "(shape: Sphere(center: ({x:?}, {y:?}, {z:?}), radius: {radius:?}), material: {material}),"
    )
}

/// A capped cylinder along z.
fn slab(from: f64, to: f64, radius: f64, material: &str) -> String {
    format!(
        "(shape: Cylinder(base: (0, 0, {from:?}), end: (0, 0, {to:?}), radius: {radius:?}, capped: true),
          material: {material}),"
    )
}

fn dielectric(ior: f64, priority: i32) -> String {
    format!("Dielectric(ior: {ior:?}, priority: {priority})")
}

fn objects(objects: &str) -> Scene {
    scene_of(CAMERA, [8, 8], objects, LAMP, "")
}

/// Calls `f` with what paths of a scene may look at.
fn with_context<T>(scene: &Scene, f: impl FnOnce(&Context<'_>) -> T) -> T {
    let plan = Plan::new(scene, &scene.settings);
    let picker = LightPicker::new(scene);
    f(&Context {
        scene,
        plan: &plan,
        picker: &picker,
        max_depth: scene.settings.max_depth,
    })
}

/// The bodies around a point; none where no bodies overlap.
fn around(ctx: &Context<'_>, p: DVec3) -> Media {
    ctx.plan.nest.as_ref().map_or(Media::NONE, |nested| {
        nested.nest.around(&ctx.scene.world, p)
    })
}

/// A change of direction on a way.
#[derive(Clone, Copy, Debug)]
struct Step {
    p: DVec3,
    dir: DVec3,
    /// Whether the light was refracted, not totally reflected.
    refracted: bool,
}

/// Refracted wherever that is possible, to the end or the `most`th change of
/// direction.
fn way(ctx: &Context<'_>, origin: DVec3, dir: DVec3, most: usize) -> Vec<Step> {
    let mut ray = Ray::new(origin, dir);
    let mut media = around(ctx, origin);
    let mut steps = Vec::new();
    while steps.len() < most {
        let Some(met) = meet(ctx, &ray, f64::INFINITY, &mut media) else {
            break;
        };
        let Some(found) = lobes(&met.material, &met.point, ray.dir, Carried::Flux) else {
            break;
        };
        let (Lobes::One(lobe) | Lobes::Two(_, lobe)) = found;
        if lobe.is_bent() {
            steps.push(Step {
                p: met.point.p,
                dir: lobe.dir,
                refracted: matches!(lobe.bend, Bend::Refract { .. }),
            });
        }
        media = media_beside(ctx, media, &met.point, lobe.dir);
        ray = met.point.spawn(lobe.dir);
    }
    steps
}

/// A ball of a clear medium, for the slow twin.
#[derive(Clone, Copy, Debug)]
struct Body {
    center: DVec3,
    radius: f64,
    ior: f64,
    priority: i32,
}

/// The index at a point: that of the ball of highest priority around it, the
/// last of equal ones.
fn index_at(bodies: &[Body], p: DVec3) -> f64 {
    let around = bodies.iter().filter(|b| p.distance(b.center) < b.radius);
    around.max_by_key(|b| b.priority).map_or(1.0, |b| b.ior)
}

/// The way of [`way`] found from the index at places alone: every sphere is
/// crossed in turn, and light bends where the index jumps. `None` where the
/// ways of neighbours part: two surfaces at once, or light that grazes.
fn slow_way(bodies: &[Body], mut p: DVec3, mut d: DVec3, most: usize) -> Option<Vec<Step>> {
    const APART: f64 = 1e-5;
    let mut steps = Vec::new();
    let mut from = 0.0;
    while steps.len() < most {
        let mut crossings: Vec<(f64, DVec3)> = Vec::new();
        for b in bodies {
            let f = p - b.center;
            let (h, k) = (f.dot(d), f.length_squared() - b.radius * b.radius);
            let root = (h * h - k).max(0.0).sqrt();
            for t in [-h - root, -h + root] {
                if h * h > k && t > from {
                    crossings.push((t, b.center));
                }
            }
            if (h * h - k).abs() < APART {
                return None;
            }
        }
        crossings.sort_by(|a, b| a.0.total_cmp(&b.0));
        let Some(&(t, center)) = crossings.first() else {
            break;
        };
        if crossings.get(1).is_some_and(|next| next.0 - t < APART) {
            return None;
        }
        let delta = 0.1 * APART;
        let [n1, n2] = [t - delta, t + delta].map(|t| index_at(bodies, p + d * t));
        if n1 == n2 {
            from = t;
            continue;
        }
        p += d * t;
        let out = (p - center).normalize();
        let n = if out.dot(d) < 0.0 { out } else { -out };
        let (r, c) = (n1 / n2, -d.dot(n));
        let squared = 1.0 - r * r * (1.0 - c * c);
        if c < 0.02 || squared.abs() < 1e-3 {
            return None;
        }
        d = if squared < 0.0 {
            d + n * (2.0 * c)
        } else {
            d * r + n * (r * c - squared.sqrt())
        };
        d = d.normalize();
        let refracted = squared > 0.0;
        steps.push(Step {
            p,
            dir: d,
            refracted,
        });
        from = APART;
    }
    Some(steps)
}

fn point(s: &mut Stream, size: f64) -> DVec3 {
    (DVec3::new(s.next_1d(), s.next_1d(), s.next_1d()) * 2.0 - DVec3::ONE) * size
}

/// Five balls at random, some equal in priority or index, and rays from
/// anywhere: light bends where the index jumps and nowhere else.
#[test]
fn light_bends_where_the_index_jumps() {
    let (mut rays, mut bends, mut total, mut inside) = (0, 0, 0, 0);
    for k in 0..40 {
        let mut s = Sequence::new(1, Purpose::Pilot, 0, k).at(0);
        let bodies: Vec<Body> = (0..5)
            .map(|_| Body {
                center: point(&mut s, 1.0),
                radius: 0.4 + s.next_1d(),
                ior: [1.0, 1.33, 1.5, 1.8][(4.0 * s.next_1d()) as usize],
                priority: (5.0 * s.next_1d()) as i32 - 2,
            })
            .collect();
        let text: String = bodies
            .iter()
            .map(|b| {
                ball(
                    b.center.to_array(),
                    b.radius,
                    &dielectric(b.ior, b.priority),
                )
            })
            .collect();
        let scene = objects(&text);
        with_context(&scene, |ctx| {
            assert!(ctx.plan.nest.is_some());
            for i in 0..100 {
                let mut s = Sequence::new(2, Purpose::Pilot, k as u32, i).at(0);
                let (p, d) = (point(&mut s, 2.0), point(&mut s, 0.8));
                let d = (d - p).normalize();
                let Some(slow) = slow_way(&bodies, p, d, 8) else {
                    continue;
                };
                let fast = way(ctx, p, d, 8);
                assert_eq!(
                    fast.len(),
                    slow.len(),
                    "scene {k}, ray {i}: {fast:?} {slow:?}"
                );
                for (a, b) in fast.iter().zip(&slow) {
                    assert_eq!(a.refracted, b.refracted);
                    // Each step magnifies what the ones before left.
                    let away = a.p.distance(b.p) + a.dir.distance(b.dir);
                    assert!(away < 1e-7, "scene {k}, ray {i}: {a:?} {b:?}");
                    total += u32::from(!a.refracted);
                }
                rays += 1;
                bends += fast.len();
                inside += u32::from(index_at(&bodies, p) > 1.0);
            }
        });
    }
    assert!(
        rays > 3000 && bends > 2 * rays && total > 200 && inside > 400,
        "{rays} rays, {bends} bends, {total} total, {inside} inside"
    );
}

/// Water around glass by priorities, whatever their order, and by an interface
/// that names both indices.
fn ball_in_water(how: usize) -> Scene {
    let center = [0.3, -0.2, 0.4];
    let water = |p| ball([0.0, 0.0, 0.0], 2.0, &dielectric(1.33, p));
    objects(&match how {
        0 => water(0) + &ball(center, 1.0, &dielectric(1.5, 1)),
        1 => ball(center, 1.0, &dielectric(1.5, 127)) + &water(-128),
        2 => water(0) + &ball(center, 1.0, "Dielectric(ior: 1.5)"),
        _ => {
            ball([0.0, 0.0, 0.0], 2.0, "Dielectric(ior: 1.33)")
                + &ball(center, 1.0, "Dielectric(ior: 1.5, outside: 1.33)")
        }
    })
}

/// Four interfaces, each by Snell's law in vectors.
#[test]
fn a_ball_in_water_follows_snell() {
    let bodies = [
        Body {
            center: DVec3::ZERO,
            radius: 2.0,
            ior: 1.33,
            priority: 0,
        },
        Body {
            center: DVec3::new(0.3, -0.2, 0.4),
            radius: 1.0,
            ior: 1.5,
            priority: 1,
        },
    ];
    for how in 0..4 {
        let scene = ball_in_water(how);
        with_context(&scene, |ctx| {
            assert_eq!(ctx.plan.nest.is_some(), how < 3);
            let mut tested = 0;
            for i in 0..200 {
                let mut s = Sequence::new(3, Purpose::Pilot, 0, i).at(0);
                let p = DVec3::new(1.2 * s.next_1d() - 0.6, 1.2 * s.next_1d() - 0.6, 5.0);
                let d = (point(&mut s, 0.4) - p).normalize();
                let Some(slow) = slow_way(&bodies, p, d, 8) else {
                    continue;
                };
                let fast = way(ctx, p, d, 8);
                assert_eq!((fast.len(), slow.len()), (4, 4), "way {how}, ray {i}");
                for (a, b) in fast.iter().zip(&slow) {
                    let away = a.p.distance(b.p).max(a.dir.distance(b.dir));
                    assert!(away < 1e-12, "way {how}, ray {i}: {a:?} {b:?}");
                }
                tested += 1;
            }
            assert!(tested > 150, "{tested} tested");
        });
    }
}

/// A liquid between two panes of glass, `overlap` of their thickness into both.
fn filled(overlap: f64) -> Scene {
    let glass = |z: f64| slab(z, z + 0.2, 3.0, &dielectric(1.5, 1));
    let reach = 0.2 * overlap;
    scene_of(
        CAMERA,
        [8, 8],
        &(glass(0.5)
            + &slab(0.7 - reach, 1.1 + reach, 2.9, &dielectric(1.33, 0))
            + &glass(1.1)
            + &ball([0.2, 0.1, 0.9], 0.1, &dielectric(1.0, 2))
            + "(shape: Quad(center: (0, 0, 0), size: (9, 9), normal: (0, 0, 1)), material: \"grey\")"),
        "Sphere(center: (0.3, 0.2, 3), radius: 0.2, power: 10)",
        "",
    )
}

/// How far a liquid reaches into its glass does not matter: not to rays, and
/// not to the photons with their footprints.
#[test]
fn overlap_depth_leaves_no_trace() {
    let [thin, deep] = [0.01, 0.5].map(filled);
    let trace = |scene: &Scene| -> Vec<Option<Photon>> {
        let paths = photon_paths(scene, 6000);
        paths.into_iter().map(|p| p.photon).collect()
    };
    let (mut same, mut parted) = (0, 0);
    for (a, b) in trace(&thin).into_iter().zip(trace(&deep)) {
        let (Some(a), Some(b)) = (a, b) else {
            assert_eq!(a.is_some(), b.is_some());
            continue;
        };
        if a.position.distance(b.position) > 1e-3 {
            // A coin on the edge of a roundoff may fall to the other side.
            parted += 1;
            continue;
        }
        assert!(a.position.distance(b.position) < 1e-11, "{a:?} {b:?}");
        assert!((a.flux.mean() - b.flux.mean()).abs() < 1e-12 * a.flux.mean());
        let (Some(f), Some(g)) = (a.footprint, b.footprint) else {
            assert_eq!(a.footprint.is_some(), b.footprint.is_some());
            continue;
        };
        assert!(
            f.major.distance(g.major) < 1e-8 * f.major.length(),
            "{f:?} {g:?}"
        );
        assert!(
            (f.minor - g.minor).abs() < 1e-8 * f.major.length(),
            "{f:?} {g:?}"
        );
        same += 1;
    }
    assert!(same > 1000 && parted < 3, "{same} same, {parted} parted");
}

/// Glass, liquid, glass: parallel faces turn nothing, and shift a ray by
/// `sum h sin i (1 - cos i / sqrt(n^2 - sin^2 i))`, whatever the overlap.
#[test]
fn a_filled_slab_shifts_by_the_sum_of_its_layers() {
    for overlap in [0.01, 0.25, 0.5] {
        let scene = filled(overlap);
        with_context(&scene, |ctx| {
            for angle in [0.0f64, 0.3, 0.9, 1.3] {
                let (s, c) = angle.sin_cos();
                let d = DVec3::new(0.0, s, -c);
                let start = DVec3::new(-0.8, -0.3, 0.9) - d * 2.0;
                let steps = way(ctx, start, d, 8);
                assert_eq!(steps.len(), 4, "overlap {overlap}, angle {angle}");
                let [a, .., z] = steps[..] else {
                    unreachable!()
                };
                assert!(z.dir.distance(d) < 1e-14);
                let shift = (z.p - a.p).cross(d).length();
                let layer = |h: f64, n: f64| h * s * (1.0 - c / (n * n - s * s).sqrt());
                let expected = 2.0 * layer(0.2, 1.5) + layer(0.4, 1.33);
                assert!(
                    (shift - expected).abs() < 1e-13,
                    "{shift} is not {expected}"
                );
            }
        });
    }
}

/// A ball lens focuses at `n r / (2 (n - 1))` from its centre, n its index
/// over that of what surrounds it; below one, before the ball.
#[test]
fn lenses_and_bubbles_in_water_focus_by_their_relative_index() {
    for (ior, around) in [(1.5, 1.33), (1.0, 1.33), (1.33, 1.6)] {
        let text = ball([0.0; 3], 1.0, &dielectric(ior, 1))
            + &slab(-20.0, 20.0, 20.0, &dielectric(around, 0));
        let scene = objects(&text);
        with_context(&scene, |ctx| {
            let height = 1e-4;
            let start = DVec3::new(height, 0.0, 5.0);
            let steps = way(ctx, start, DVec3::NEG_Z, 2);
            let out = steps[1];
            let along = out.p.x / out.dir.x;
            let found = -(out.p.z - along * out.dir.z);
            let n = ior / around;
            let expected = n / (2.0 * (n - 1.0));
            // The aberration at height h is of the order h^2.
            assert!(
                (found - expected).abs() < 1e-6,
                "{ior} in {around}: {found} instead of {expected}"
            );
        });
    }
}

/// A bubble reflects totally where a ray passes its centre at more than r / n.
#[test]
fn a_bubble_reflects_totally_beyond_its_critical_height() {
    let text =
        slab(-20.0, 20.0, 20.0, &dielectric(1.33, 0)) + &ball([0.0; 3], 1.0, &dielectric(1.0, 1));
    let scene = objects(&text);
    with_context(&scene, |ctx| {
        for (factor, refracted) in [(1.0 - 1e-9, true), (1.0 + 1e-9, false)] {
            let start = DVec3::new(factor / 1.33, 0.0, 5.0);
            let step = way(ctx, start, DVec3::NEG_Z, 1)[0];
            assert_eq!(step.refracted, refracted, "{step:?}");
        }
    });
}

/// Snell's window: from under water the sky fills a cone whose half-angle has
/// the sine 1 / 1.33; beyond, the surface mirrors. The lens of the camera
/// stands in a ball of glass.
#[test]
fn the_sky_under_water_fills_snells_window() {
    let text = slab(-20.0, 0.0, 20.0, &dielectric(1.33, 0))
        + &ball([0.0, 0.0, -4.0], 1.0, &dielectric(1.5, 1));
    let camera = "eye: (0, 0, -4), look_at: (0, 0, 0), up: (0, 1, 0), fov: 120";
    let scene = scene_of(camera, [8, 8], &text, LAMP, "");
    with_context(&scene, |ctx| {
        let critical = (1.0f64 / 1.33).asin();
        for (angle, sky) in [
            (0.0, true),
            (0.5 * critical, true),
            (critical - 1e-7, true),
            (critical + 1e-7, false),
            (1.2 * critical, false),
        ] {
            // Through the middle of the ball rays go straight.
            let d = DVec3::new(angle.sin(), 0.0, angle.cos());
            let mut walker = Walker::from_camera(ctx, Ray::new(DVec3::new(0.0, 0.0, -4.0), d));
            let nested = ctx.plan.nest.as_ref().expect("two bodies");
            assert_eq!(nested.nest.medium(&walker.media), Some(1));
            let met = meet(ctx, &walker.ray, f64::INFINITY, &mut walker.media).expect("the ball");
            let out = met.point.spawn(d);
            let mut beyond = media_beside(ctx, walker.media, &met.point, d);
            let step = meet(ctx, &out, f64::INFINITY, &mut beyond).expect("the surface");
            let found = lobes(&step.material, &step.point, d, Carried::Radiance);
            let two = matches!(found, Some(Lobes::Two(..)));
            assert_eq!(two, sky, "at {angle}");
        }
    });
}

/// Radiance that has left all media is what it was: no body, however nested,
/// shows in an even surrounding. From within it is brighter by the squared
/// index of the place.
#[test]
fn nested_media_do_not_show_in_an_even_surrounding() {
    let bodies = [
        Body {
            center: DVec3::ZERO,
            radius: 1.5,
            ior: 1.33,
            priority: 0,
        },
        Body {
            center: DVec3::new(0.5, 0.0, 0.6),
            radius: 1.2,
            ior: 1.5,
            priority: 1,
        },
        Body {
            center: DVec3::new(0.2, 0.1, 0.9),
            radius: 0.7,
            ior: 1.0,
            priority: 2,
        },
    ];
    let text: String = bodies
        .iter()
        .map(|b| {
            ball(
                b.center.to_array(),
                b.radius,
                &dielectric(b.ior, b.priority),
            )
        })
        .collect();
    let scene = objects(&text);
    with_context(&scene, |ctx| {
        let mut seen = [0; 3];
        for i in 0..2000 {
            let mut s = Sequence::new(6, Purpose::Pilot, 0, i).at(0);
            let (p, d) = (point(&mut s, 2.0), warp::sphere(s.next_2d()).normalize());
            let mut path = Walker::new(Ray::new(p, d), around(ctx, p));
            let mut coins = Sequence::new(6, Purpose::Pilot, 1, i).at(0);
            if let End::Truncated = path.walk(ctx, &mut coins, &mut |_| false) {
                continue;
            }
            let n = index_at(&bodies, p);
            assert_close(path.throughput[1], n * n, 1e-13, "throughput");
            assert!(path.media == Media::NONE);
            seen[[1.0, 1.33, 1.5]
                .iter()
                .position(|&x| x == n)
                .expect("an index")] += 1;
        }
        assert!(seen.iter().all(|&n| n > 150), "{seen:?}");
    });
}

/// The same scene by priorities and with every interface written out is the
/// same picture, bit by bit.
#[test]
fn priorities_and_explicit_interfaces_make_the_same_picture() {
    let picture = |inner: &str| {
        let objects = ball([0.0, 0.0, 1.2], 1.0, "Dielectric(ior: 1.33)")
            + &ball([0.1, 0.0, 1.3], 0.6, inner)
            + "(shape: Quad(center: (0, 0, 0), size: (9, 9), normal: (0, 0, 1)), material: \"grey\")";
        let scene = scene_of(
            CAMERA,
            [16, 12],
            &objects,
            "Sphere(center: (1, 0, 5), radius: 0.3, power: 100)",
            "passes: 8, photons: 4096",
        );
        render(&scene).film.image().pixels().to_vec()
    };
    let nested = picture("Dielectric(ior: 1.5, priority: 3)");
    assert!(nested == picture("Dielectric(ior: 1.5, outside: 1.33)"));
    assert!(nested != picture("Dielectric(ior: 1.5, outside: 1)"));
}

/// What leaves glass around a lamp, in water, is what Fresnel lets through;
/// with all inner reflections it is everything.
#[test]
fn light_leaves_the_glass_around_it() {
    let (inner, outer) = (reflectance(0.0, 1.33 / 1.5), reflectance(0.0, 1.0 / 1.33));
    for (depth, expected) in [(2, (1.0 - inner) * (1.0 - outer)), (60, 1.0)] {
        let text = ball([0.0; 3], 2.0, &dielectric(1.33, 0))
            + &ball([0.0; 3], 1.0, &dielectric(1.5, 1))
            + &ball([0.0; 3], 5.0, "Diffuse(reflectance: 0)");
        let scene = scene_of(
            CAMERA,
            [8, 8],
            &text,
            "Point(position: (0, 0, 0), power: 20)",
            &format!("max_depth: {depth}, indirect: false"),
        );
        // At normal incidence nothing is bent, but refracted all the same.
        let stored: Vec<f64> = photon_paths(&scene, 20_000)
            .iter()
            .map(|p| p.tally.stored)
            .collect();
        let estimate = Estimate::of(&stored);
        assert!(
            (estimate.mean - 20.0 * expected).abs() <= 5.0 * estimate.error + 1e-9,
            "{estimate:?}, expected {}",
            20.0 * expected
        );
        assert!(estimate.error < 0.03);
    }
}

/// A lamp half in the water: its photons know on which side they start, and
/// shadow rays from within pass what is hidden and nothing else.
#[test]
fn starts_and_shadow_rays_know_their_side() {
    let text = slab(-2.0, 0.0, 3.0, &dielectric(1.33, 0))
        + &slab(-2.0, -1.0, 1.0, &dielectric(1.33, -1))
        + &slab(-2.5, -1.8, 4.0, "Diffuse(reflectance: 0.5)");
    let lamps = "Sphere(center: (0, 0, 0), radius: 0.5, power: 10),
        Point(position: (1.5, 0, -0.2), power: 5), Point(position: (0, 0, 2), power: 5)";
    let scene = scene_of(CAMERA, [8, 8], &text, lamps, "");
    let mut sides = [0; 2];
    for path in photon_paths(&scene, 2000) {
        let start = path.emission;
        if start.light == 0 {
            let below = start.ray.origin.z < 0.0;
            assert_eq!(start.media.top().is_some(), below, "{:?}", start.ray);
            sides[usize::from(below)] += 1;
        }
    }
    assert!(sides.iter().all(|&n| n > 100), "{sides:?}");
    with_context(&scene, |ctx| {
        // From the floor, below the hidden slab.
        let from = DVec3::new(0.1, 0.2, -1.7);
        let mut media = around(ctx, from);
        assert_eq!(media.ranks(), [0, 1]);
        let ray = Ray::new(from, DVec3::NEG_Z);
        let met = meet(ctx, &ray, f64::INFINITY, &mut media).expect("the floor");
        let share = |light: usize| {
            let named = &ctx.scene.lights[light];
            let sample = named
                .light
                .sample_direct(met.point.p, [0.5; 2])
                .expect("a sample");
            transmittance(ctx, &met.point, &media, &sample, named.instance)
        };
        assert_eq!(share(1), 1.0, "in the same water");
        assert_eq!(share(2), 0.0, "beyond the surface");
    });
}

/// Watt by watt, also where photons start inside and bounce under water.
#[test]
fn the_ledger_balances_under_water() {
    let scene = filled(0.5);
    let tank = scene_of(
        CAMERA,
        [8, 8],
        &(slab(-1.0, 1.0, 2.0, &dielectric(1.33, 0))
            + &slab(-1.5, -0.5, 1.9, "\"grey\"")
            + &ball([0.3, 0.0, 0.9], 0.4, &dielectric(1.31, 1))
            + &ball([-0.4, 0.0, 0.0], 0.3, &dielectric(1.0, 2))),
        "Sphere(center: (0, 0, 0.5), radius: 0.1, power: 10), Point(position: (1, 0, 4), power: 30)",
        "passes: 2, photons: 8192",
    );
    for scene in [scene, tank] {
        let report = render(&scene).report;
        for light in &report.lights {
            let ledger = &light.ledger;
            assert!(ledger.stored > 0.0);
            assert!(
                ledger.imbalance().abs() <= 1e-9 * ledger.launched,
                "{}: {} W",
                light.name,
                ledger.imbalance()
            );
        }
    }
}

/// Bodies that lie apart, panes, open surfaces and explicit interfaces ask for
/// none of this.
#[test]
fn only_bodies_that_come_near_each_other_are_nested() {
    let apart = ball([0.0; 3], 1.0, "\"glass\"") + &ball([1.5, 1.5, 0.0], 1.0, "\"glass\"");
    let touching = ball([0.0; 3], 1.0, "\"glass\"") + &ball([1.4, 1.4, 0.0], 1.0, "\"glass\"");
    let explicit = ball([0.0; 3], 1.0, "\"glass\"")
        + &ball([0.0; 3], 0.5, "Dielectric(ior: 1, outside: 1.5)")
        + "(shape: Disc(center: (0, 0, 0), normal: (0, 0, 1), radius: 2), material: \"glass\", open: true)";
    let deep: String = (1..=12)
        .map(|i| {
            ball(
                [0.0; 3],
                f64::from(i),
                &dielectric(1.0 + 0.05 * f64::from(i), -i),
            )
        })
        .collect();
    for (text, nested) in [
        (&apart, false),
        (&touching, true),
        (&explicit, false),
        (&deep, true),
    ] {
        let scene = objects(text);
        with_context(&scene, |ctx| {
            assert_eq!(ctx.plan.nest.is_some(), nested, "{text}");
        });
    }
    // Seven are remembered; the innermost of twelve is among them.
    let scene = objects(&deep);
    with_context(&scene, |ctx| {
        let media = around(ctx, DVec3::ZERO);
        assert_eq!(media.ranks(), [5, 6, 7, 8, 9, 10, 11]);
    });
}
