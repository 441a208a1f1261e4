//! Spheres around the objects that light or sight is aimed at: few enough to ask
//! each start about all of them.

use glam::DVec3;

use crate::{geometry::BoundingSphere, numeric::U};

/// Largest number of parts a light's domain is divided into; more casters are
/// grouped. A start may ask every part whether it lies there, so this bounds
/// the work.
pub(super) const MAX_TARGETS: usize = 16;

/// The spheres by size, without those that lie inside another.
pub(super) fn outermost(mut spheres: Vec<BoundingSphere>) -> Vec<BoundingSphere> {
    spheres.sort_by(|a, b| a.radius.total_cmp(&b.radius));
    let inside = |s: &BoundingSphere, larger: &BoundingSphere| {
        s.center.distance(larger.center) + s.radius <= larger.radius
    };
    (0..spheres.len())
        .filter(|&i| !spheres[i + 1..].iter().any(|l| inside(&spheres[i], l)))
        .map(|i| spheres[i])
        .collect()
}

/// At most so many spheres that cover the given ones. While there may be more
/// groups, the one of the largest `extent` is halved by median along its widest
/// axis. If that is the part of a light's domain that leads there, near casters
/// get targets of their own, distant ones share.
pub(crate) fn grouped(
    mut spheres: Vec<BoundingSphere>,
    most: usize,
    extent: impl Fn(&BoundingSphere) -> f64,
) -> Vec<BoundingSphere> {
    if spheres.len() <= most {
        return spheres;
    }
    let Some(all) = cover(&spheres) else {
        return spheres;
    };
    let mut groups = vec![(all, spheres.as_mut_slice())];
    while groups.len() < most {
        let size = |(sphere, members): &(BoundingSphere, &mut [BoundingSphere])| {
            let single = members.len() < 2;
            if single { -1.0 } else { extent(sphere) }
        };
        let widest = (0..groups.len())
            .max_by(|&a, &b| size(&groups[a]).total_cmp(&size(&groups[b])))
            .unwrap_or(0);
        let (sphere, members) = groups.swap_remove(widest);
        let (low, high) = halves(members);
        match (cover(low), cover(high)) {
            (Some(a), Some(b)) => groups.extend([(a, low), (b, high)]),
            // Too few to halve.
            _ => return groups.into_iter().map(|g| g.0).chain([sphere]).collect(),
        }
    }
    groups.into_iter().map(|g| g.0).collect()
}

/// Halves spheres by the median of their centres along the widest axis.
fn halves(group: &mut [BoundingSphere]) -> (&mut [BoundingSphere], &mut [BoundingSphere]) {
    let spread = |axis: usize| {
        let c = group.iter().map(|s| s.center[axis]);
        c.clone().fold(f64::MIN, f64::max) - c.fold(f64::MAX, f64::min)
    };
    let axis = (0..3)
        .max_by(|a, b| spread(*a).total_cmp(&spread(*b)))
        .unwrap_or(0);
    group.sort_by(|a, b| a.center[axis].total_cmp(&b.center[axis]));
    group.split_at_mut(group.len() / 2)
}

/// A sphere around spheres, centred at the mean of their centres.
fn cover(group: &[BoundingSphere]) -> Option<BoundingSphere> {
    if group.is_empty() {
        return None;
    }
    let center = group.iter().map(|s| s.center).sum::<DVec3>() / group.len() as f64;
    let radius = group
        .iter()
        .map(|s| s.center.distance(center) + s.radius)
        .fold(0.0, f64::max);
    Some(BoundingSphere {
        center,
        radius: radius * (1.0 + 8.0 * U),
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{
        light::{Light, PointLight},
        photon::domain,
        spectrum::Rgb,
    };

    /// Sixty balls in a row, a lamp beside one of them: few groups, which
    /// cover all, and those next to the lamp are alone in theirs.
    #[test]
    fn near_casters_are_targets_of_their_own() {
        let ball = |i: u32| BoundingSphere {
            center: DVec3::new(4.0 * f64::from(i), 0.0, 0.0),
            radius: 0.5,
        };
        let spheres: Vec<_> = (0..60).map(ball).collect();
        let lamp = Light::Point(PointLight {
            position: DVec3::new(4.0 * 37.0, 0.0, 2.0),
            intensity: Rgb::WHITE,
        });
        let extent = |s: &BoundingSphere| domain::extent(&lamp, s);
        let groups = grouped(spheres.clone(), MAX_TARGETS, extent);
        assert_eq!(groups.len(), MAX_TARGETS);
        for s in &spheres {
            let covered = |g: &BoundingSphere| {
                s.center.distance(g.center) + s.radius <= g.radius * (1.0 + 1e-12)
            };
            assert!(groups.iter().any(covered), "{s:?} is not covered");
        }
        for i in 36..39 {
            let own = |g: &BoundingSphere| g.center == ball(i).center && g.radius < 0.51;
            assert!(groups.iter().any(own), "ball {i} shares its group");
        }
        // Twins cannot be parted, whatever their number.
        let twins = vec![ball(0); 40];
        assert!(grouped(twins, MAX_TARGETS, extent).len() <= MAX_TARGETS);
    }

    /// Ten balls in a row, each with a smaller one inside it, and a twin: the
    /// large ones remain, once each, the smallest first.
    #[test]
    fn balls_inside_others_are_no_targets() {
        let ball = |x: f64, radius| BoundingSphere {
            center: DVec3::new(x, 0.0, 0.0),
            radius,
        };
        let mut spheres = Vec::new();
        for i in (0..10).rev() {
            let x = f64::from(i);
            let radius = 0.5 + 0.1 * x;
            spheres.extend([
                ball(4.0 * x, radius),
                ball(4.0 * x + 0.2, radius - 0.25),
                ball(4.0 * x, radius),
            ]);
        }
        let left = outermost(spheres);
        let expected: Vec<_> = (0..10)
            .map(f64::from)
            .map(|x| ball(4.0 * x, 0.5 + 0.1 * x))
            .collect();
        assert_eq!(left, expected);
        // One that only reaches out of another stays.
        assert_eq!(outermost(vec![ball(0.0, 1.0), ball(0.8, 0.3)]).len(), 2);
    }
}
