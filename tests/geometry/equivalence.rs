//! The tree against testing everything.

use std::sync::Arc;

use glam::DVec3;
use nephroid::geometry::{Hit, Instance, Ray, Shape, World, brute, shape::Sphere};
use proptest::prelude::*;

use crate::scenes::{self, Random, single, sphere_mesh};

/// Both must be the same hit. Where two surfaces are met at the same `t`,
/// either may win: then the winner alone must give that `t`.
fn agree(world: &World, ray: &Ray, fast: Option<Hit>, slow: Option<Hit>) -> Result<(), String> {
    let same = match (fast, slow) {
        (None, None) => true,
        (Some(f), Some(s)) if f.surface == s.surface => f == s,
        (Some(f), Some(s)) => {
            let instance = &world.instances()[f.surface.instance as usize];
            let leaving = ray
                .leaving
                .filter(|l| l.instance == f.surface.instance)
                .map(|l| l.part);
            f.t == s.t && instance.intersect(ray, f64::INFINITY, leaving).map(|h| h.t) == Some(f.t)
        }
        _ => false,
    };
    if same {
        Ok(())
    } else {
        Err(format!("{ray:?}: {fast:?} but {slow:?}"))
    }
}

fn compare(world: &World, ray: &Ray, t_max: f64) -> Result<Option<Hit>, TestCaseError> {
    let fast = world.closest(ray, t_max);
    agree(world, ray, fast, brute::closest(world, ray, t_max)).map_err(TestCaseError::fail)?;
    let odd = |i: u32| i % 2 == 1;
    prop_assert_eq!(world.occluded(ray, t_max, |_| false), fast.is_some());
    prop_assert_eq!(
        world.occluded(ray, t_max, odd),
        brute::occluded(world, ray, t_max, odd)
    );
    Ok(fast)
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(96))]

    #[test]
    fn random_worlds(seed: u64, count in 1u64..40) {
        let mut random = Random(seed);
        let world = scenes::world(&mut random, count);
        for _ in 0..100 {
            let mut ray = scenes::ray(&mut random, &world);
            let t_max = if random.below(3) == 0 { random.range(0.1, 5.0) } else { f64::INFINITY };
            // Follow the ray, so that rays that leave surfaces are compared, too.
            for _ in 0..4 {
                let Some(hit) = compare(&world, &ray, t_max)? else { break };
                ray = world.surface(&ray, &hit).spawn(random.direction());
            }
        }
    }

    #[test]
    fn meshes_at_any_scale(seed: u64, exponent in -8.0..8.0f64, away in 0.0..1e4f64) {
        let mut random = Random(seed);
        let size = libm::exp10(exponent);
        let center = random.direction() * away * size;
        let mesh = sphere_mesh(&mut random, 12, center, size, 0.3);
        let world = single(Shape::Mesh(Arc::new(mesh)), None);
        for _ in 0..100 {
            let origin = center + random.vector(2.0) * size;
            let target = center + random.vector(0.9) * size;
            let ray = Ray::new(origin, (target - origin).normalize());
            compare(&world, &ray, f64::INFINITY)?;
        }
    }
}

#[test]
fn coincident_surfaces_and_shared_meshes() {
    let mut random = Random(5);
    let mesh = Arc::new(sphere_mesh(&mut random, 6, DVec3::ZERO, 1.0, 0.0));
    let instances = (0..20).map(|i| Instance {
        shape: if i % 2 == 0 {
            Shape::Mesh(mesh.clone())
        } else {
            Shape::Sphere(Sphere::new(DVec3::ZERO, 1.0))
        },
        transform: (i % 4 == 0).then(|| random.transform(0.5)),
    });
    let world = World::new(instances.collect());
    let mut random = Random(6);
    for _ in 0..2000 {
        let ray = scenes::ray(&mut random, &world);
        compare(&world, &ray, f64::INFINITY).unwrap();
    }
}

#[test]
fn empty_world_and_rays_that_do_not_exist() {
    let empty = World::new(Vec::new());
    let ray = Ray::new(DVec3::ZERO, DVec3::X);
    assert_eq!(empty.closest(&ray, f64::INFINITY), None);
    assert!(!empty.occluded(&ray, f64::INFINITY, |_| false));
    assert_eq!(empty.bounds(), None);
    let mut random = Random(1);
    let world = scenes::world(&mut random, 30);
    let broken = [
        DVec3::splat(f64::NAN),
        DVec3::new(0.0, f64::NAN, 1.0),
        DVec3::ZERO,
    ];
    for dir in broken {
        assert_eq!(
            world.closest(&Ray::new(DVec3::ONE, dir), f64::INFINITY),
            None,
            "{dir}"
        );
    }
    let nowhere = Ray::new(DVec3::new(f64::NAN, 0.0, 0.0), DVec3::X);
    assert_eq!(world.closest(&nowhere, f64::INFINITY), None);
}
