//! A hunt for leaks on every closed shape: rays leave points of the surface,
//! and what is inside, by a formula that knows nothing of rays, tells whether
//! they should meet it again.

use nephroid::geometry::{Ray, Surface, SurfacePoint, World};

use crate::{
    known::{Known, known},
    leaks::Bag,
    scenes::{Random, single},
};

/// Sizes, and distances from the origin in sizes.
const SCALES: [f64; 4] = [1e-4, 1.0, 1e2, 1e5];
const SHIFTS: [f64; 4] = [0.0, 1.0, 30.0, 1e3];

/// Places along a ray at which the formula is asked: each is farther than the
/// one before by this factor.
const STEP: f64 = 1.25;

/// Shoots `count` rays from points of shapes of a kind.
pub(crate) fn hunt_known(kind: u64, seed: u64, count: u64) -> Bag {
    hunt_grown(kind, seed, count, 1.0)
}

/// The same, judged as if the shapes were larger by a factor.
fn hunt_grown(kind: u64, seed: u64, count: u64, factor: f64) -> Bag {
    let mut random = Random(seed);
    let mut bag = Bag::default();
    while bag.rays < count {
        let size = SCALES[random.below(4) as usize];
        let away = SHIFTS[random.below(4) as usize] * size;
        let at = random.direction() * away;
        let mut k = known(&mut random, kind, at, size);
        if factor != 1.0 {
            let level = k.level;
            k.level = Box::new(move |p| level(at + (p - at) / factor));
        }
        // A quadric's coefficients are rounded as the square of where it is.
        let slack = 1e-9 * size + 1e-12 * away + 1e-15 * away * away / size;
        let world = single(k.shape.clone(), None);
        let sphere = k.shape.bounding_sphere().expect("bounded");
        for _ in 0..64 {
            let from = sphere.center + random.direction() * sphere.radius * random.range(0.0, 4.0);
            let to = sphere.center + random.vector(0.7) * sphere.radius;
            let ray = Ray::new(from, (to - from).normalize());
            let Some(hit) = world.closest(&ray, f64::INFINITY) else {
                continue;
            };
            let point = world.surface(&ray, &hit);
            let mut dir = random.direction();
            if random.below(2) == 0 {
                let lift = libm::exp10(random.range(-9.0, 0.0)) * random.range(-1.0, 1.0);
                dir = (dir - point.ng * dir.dot(point.ng) + point.ng * lift).normalize();
            }
            let leave = point.spawn(dir);
            bag = bag.plus(judge(
                &k,
                &world,
                &point,
                &leave,
                slack,
                3.0 * sphere.radius,
            ));
        }
    }
    bag
}

/// Whether what a ray meets is what the formula says; `far` is as long as any
/// way through the shape.
fn judge(k: &Known, world: &World, point: &SurfacePoint, ray: &Ray, slack: f64, far: f64) -> Bag {
    let mut bag = Bag {
        rays: 1,
        ..Bag::default()
    };
    let level = |t: f64| (k.level)(point.p + ray.dir * t);
    let found = world.closest(ray, f64::INFINITY);
    let end = found.map_or(far, |hit| hit.t);
    // What lies ahead: inside or outside, where the formula is sure.
    let (mut inside, mut outside) = (0, 0);
    let mut t = slack;
    while t < end {
        match level(t) {
            l if l < -slack => inside += 1,
            l if l > slack => outside += 1,
            _ => {}
        }
        t *= STEP;
    }
    if found.is_none() {
        bag.missed = u64::from(inside > 0);
        bag.undecided = u64::from(inside + outside == 0);
        return bag;
    }
    if inside > 0 && outside > 0 {
        bag.missed = 1;
        return bag;
    }
    if level(end).abs() > slack.max(1e-6 * end) {
        bag.false_hits = 1;
        return bag;
    }
    if inside + outside == 0 {
        bag.undecided = 1;
        return bag;
    }
    // Behind a crossing is the other side, up to the next one.
    let hit = found.expect("checked above");
    let beyond = world.surface(ray, &hit).spawn(ray.dir);
    let until = world.closest(&beyond, far).map_or(far, |hit| hit.t);
    let mut t = slack;
    while t < until {
        let l = level(end + t);
        if l.abs() > slack {
            bag.false_hits = u64::from((l < 0.0) == (inside > 0));
            return bag;
        }
        t *= STEP;
    }
    bag.undecided = 1;
    bag
}

#[test]
fn no_ray_goes_astray() {
    for kind in 0..crate::known::KINDS {
        let bag = hunt_known(kind, 5 + kind, 4000);
        assert_eq!(bag.leaks(), 0, "kind {kind}: {bag:?}");
        assert!(bag.undecided * 2 < bag.rays, "kind {kind}: {bag:?}");
    }
}

#[test]
fn another_shape_is_noticed() {
    for kind in 0..crate::known::KINDS {
        let bag = hunt_grown(kind, 5, 2000, 1.001);
        assert!(20 * bag.leaks() > bag.rays, "kind {kind}: {bag:?}");
    }
}
