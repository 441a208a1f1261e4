//! Balls at random against a slow twin that knows nothing of surfaces in each
//! other: only the index at a place.

use glam::DVec3;
use nephroid::{
    sampling::{Purpose, Sequence, Stream},
    scene::Scene,
};

use crate::{Step, ball, dielectric, objects, way, with_context};

/// A ball of a clear medium, for the slow twin.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Body {
    pub(crate) center: DVec3,
    pub(crate) radius: f64,
    pub(crate) ior: f64,
    pub(crate) priority: i32,
}

/// A scene of these balls.
pub(crate) fn scene_with(bodies: &[Body]) -> Scene {
    let text = |b: &Body| {
        let material = dielectric(b.ior, b.priority);
        ball(b.center.to_array(), b.radius, &material)
    };
    objects(&bodies.iter().map(text).collect::<String>())
}

/// The index at a point: that of the ball of highest priority around it, the
/// last of equal ones.
pub(crate) fn index_at(bodies: &[Body], p: DVec3) -> f64 {
    let around = bodies.iter().filter(|b| p.distance(b.center) < b.radius);
    around.max_by_key(|b| b.priority).map_or(1.0, |b| b.ior)
}

/// The way of [`way`] found from the index at places alone: every sphere is
/// crossed in turn, and light bends where the index jumps. `None` where the
/// ways of neighbours part: two surfaces at once, or light that grazes.
pub(crate) fn slow_way(
    bodies: &[Body],
    mut p: DVec3,
    mut d: DVec3,
    most: usize,
) -> Option<Vec<Step>> {
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

pub(crate) fn point(s: &mut Stream, size: f64) -> DVec3 {
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
        let scene = scene_with(&bodies);
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
