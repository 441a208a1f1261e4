//! Clear surfaces that stand on opaque ones, as a glass on its table.
//!
//! Where both are in one place the nearer one would count by a rounding, and
//! half of the light would go on below the table. There the opaque one counts,
//! as if the table reached a little into the glass; see `transport::meet`.

use crate::{
    geometry::{Aabb, Surface},
    numeric::gamma,
    scene::Scene,
};

use super::nest::ROUNDINGS;

/// A clear object and an opaque one whose surfaces may have a piece in common;
/// `None` if there surely are no such two. What is curved everywhere and what
/// is flat everywhere have points in common at most.
pub(super) fn first_contact(scene: &Scene) -> Option<[u32; 2]> {
    let world = &scene.world;
    let opaque = |i: u32| scene.objects[i as usize].material.is_opaque();
    let pieces = |i: u32| world.instances()[i as usize].shape.pieces();
    let clear = (0u32..).zip(&scene.objects).map(|(i, _)| i);
    clear.filter(|&i| !opaque(i)).find_map(|clear| {
        // What has no bounds is open, and stands on nothing.
        let region = padded(world.instance_bounds(clear)?);
        let sphere = region.bounding_sphere();
        let may_share = |i: u32| opaque(i) && pieces(i).may_coincide(pieces(clear));
        let (others, _) = world.neighbours(sphere.center, sphere.radius, may_share);
        let meets = |&i: &u32| {
            let instances = world.instances();
            let lies = |axis: usize, ends: [f64; 2]| {
                [clear, i].map(|i| instances[i as usize].may_lie_between(axis, ends)) == [true; 2]
            };
            world
                .instance_bounds(i)
                .is_none_or(|b| share_a_piece(&region, &padded(b), lies))
                && instances[i as usize].may_meet(&region)
        };
        others.into_iter().find(meets).map(|other| [clear, other])
    })
}

/// What touches may be parted by some roundings.
fn padded(b: Aabb) -> Aabb {
    b.padded(gamma(ROUNDINGS) * b.max_abs())
}

/// Whether what is in two boxes may have more than edges in common: where these
/// only touch, both must have a piece in the thin box that they share. `lies`
/// tells whether they have one between two coordinates of an axis. (A surface
/// of water that ends at a wall has none.)
fn share_a_piece(a: &Aabb, b: &Aabb, lies: impl Fn(usize, [f64; 2]) -> bool) -> bool {
    let shared = a.intersection(*b);
    let thin = 4.0 * gamma(ROUNDINGS) * a.max_abs().max(b.max_abs());
    let extent = shared.max - shared.min;
    !shared.is_empty()
        && (0..3)
            .all(|axis| extent[axis] > thin || lies(axis, [shared.min[axis], shared.max[axis]]))
}
