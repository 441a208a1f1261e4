//! The weights of a path's strategies.
//!
//! A path of n places can be made in up to n ways: t places from the camera,
//! the other s = n - t from the light. With the density `p_t` of each way, the
//! power heuristic gives way t the weight `p_t^2 / sum of p_k^2` (Veach 1997,
//! sections 9.2 and 10.2); over all ways they sum to one.
//!
//! Only ratios of densities matter, and those of neighbouring ways differ in
//! one place. A crossing in a straight line is no place, and the chance of it
//! is left out of all densities alike.

/// One place of a path, counted from the camera.
#[derive(Clone, Copy, Debug)]
pub(super) struct Place {
    /// Density with which the path from the camera comes there.
    pub(super) camera: f64,
    /// Density with which the path from the light comes there, unless it
    /// starts there.
    pub(super) light: f64,
    /// Whether light can be scattered there in any direction.
    pub(super) open: bool,
}

/// How a path can begin at its light.
#[derive(Clone, Copy, Debug)]
pub(super) struct Ends {
    /// Paths from lights that are connected to the camera.
    pub(super) paths: f64,
    /// Density of the seat where a path starts with it.
    pub(super) origin: f64,
    /// Density of the seat where it is sampled from the place before.
    pub(super) direct: f64,
    /// Whether a camera path can hit the light.
    pub(super) hittable: bool,
}

/// Weight of the strategy with `t` places from the camera, of a path whose
/// first place is the eye and whose last one is on a light. The densities of
/// the places that this strategy made must be above 0.
pub(super) fn weight(places: &[Place], ends: &Ends, t: usize) -> f64 {
    let n = places.len();
    // Density of k places from the camera over that of k - 1.
    let step = |k: usize| {
        let (s, place) = (n - k, &places[k - 1]);
        let from_light = match s {
            0 => ends.direct,
            1 => place.light * ends.origin / ends.direct,
            _ => place.light,
        };
        let paths = if k == 2 { ends.paths } else { 1.0 };
        place.camera / (from_light * paths)
    };
    let mut sum = 1.0;
    let mut ratio = 1.0;
    for k in t + 1..=n {
        ratio *= step(k);
        if possible(places, ends, k) {
            sum += ratio * ratio;
        }
    }
    ratio = 1.0;
    for k in (2..=t).rev() {
        ratio /= step(k);
        if possible(places, ends, k - 1) {
            sum += ratio * ratio;
        }
    }
    1.0 / sum
}

/// Whether a path can be made with `t` places from the camera.
pub(super) fn possible(places: &[Place], ends: &Ends, t: usize) -> bool {
    let n = places.len();
    match t {
        0 => false,
        // A light sampled first and then seen is what the camera hits.
        1 => n >= 3 && places[1].open,
        _ if t == n => ends.hittable,
        _ => places[t - 1].open && (t == n - 1 || places[t].open),
    }
}
