//! The photon map: a kd-tree over landed photons, asked for irradiance.
//!
//! This is the only file that knows the kd-tree crate. Positions are `f32`
//! relative to the photons' median, so that they are finest where most light
//! is, whatever flies far away; and they are turned by a fixed rotation first:
//! on axis-aligned floors every third split of the tree would otherwise be
//! wasted. Photons are kept along a space-filling curve, so that those of one
//! query lie together in memory. The tree reports them in an order that
//! depends on the photons alone, so sums are reproducible.

use std::f64::consts::FRAC_2_PI;

use glam::{DMat3, DVec3, Vec3};
use kiddo::{Eytzinger, FlatVec, KdTree, SquaredEuclidean};
use rayon::prelude::*;

use crate::spectrum::Rgb;

use super::Photon;

type Tree = KdTree<f32, u32, Eytzinger, FlatVec<f32, u32, 3, 32>, 3, 32>;

/// Memory that a stored photon needs while its pass is built, in bytes: the
/// traced record (twice, while chunks are joined), the photon at rest (twice,
/// while it is sorted) with its sort key, and the tree. The `memory` bench
/// measures the peak.
pub const BYTES_PER_PHOTON: u64 =
    2 * size_of::<Photon>() as u64 + 2 * size_of::<Stored>() as u64 + 8 + 24;

/// Photons whose surface normal differs more than this from the query's
/// (cosine) lie on another face.
const SAME_FACE_COSINE: f32 = 0.7;

/// Half-height of the gather region over its radius: photons further off the
/// query's tangent plane belong to another surface.
const SLAB: f32 = 0.5;

/// A photon at rest, 28 bytes.
#[derive(Clone, Copy, Debug)]
struct Stored {
    position: [f32; 3],
    flux: [f32; 3],
    /// The normal's code, its lowest bit replaced by the kind of photon.
    normal: u32,
}

/// The bit of [`Stored::normal`] that marks a photon as bounced.
const BOUNCED: u32 = 1;

/// The answer to a density query.
#[derive(Clone, Copy, Debug, Default)]
pub struct Gathered {
    /// Irradiance in W/m2 by light that came from its source through specular
    /// steps alone.
    pub irradiance: Rgb,
    /// Irradiance in W/m2 by light of which a diffuse surface had made such a
    /// caustic before it reflected it here.
    pub bounced: Rgb,
    /// Photons looked at: the work done.
    pub visited: u32,
}

/// The photons of one pass, ready to be asked.
pub struct PhotonMap {
    tree: Option<Tree>,
    stored: Vec<Stored>,
    center: DVec3,
    rotation: DMat3,
    per_path: f64,
    refused: u64,
}

impl PhotonMap {
    /// Builds the map of the photons of `emitted` paths. Photons that are not
    /// finite are refused and counted.
    pub fn new(photons: &[Photon], emitted: u64) -> Self {
        let rotation = off_axis();
        let finite = |p: &&Photon| p.position.is_finite() && p.flux.is_finite();
        let kept: Vec<&Photon> = photons.iter().filter(finite).collect();
        let refused = (photons.len() - kept.len()) as u64;
        let center = median(&kept);
        let stored: Vec<Stored> = kept
            .par_iter()
            .map(|p| Stored {
                position: (rotation * (p.position - center)).as_vec3().to_array(),
                flux: p.flux.0.map(|c| c as f32),
                normal: encode((rotation * p.normal).as_vec3()) & !BOUNCED | u32::from(p.bounced),
            })
            .collect();
        drop(kept);
        let stored = along_curve(&stored);
        // The builder refuses nothing that is finite and indexable by u32,
        // and the budget of a pass keeps the count far below 2^32.
        let tree = if stored.is_empty() {
            None
        } else {
            Tree::new_from_source_parallel(&stored, |p, axis| p.position[axis], |i, _| i as u32)
                .ok()
        };
        let per_path = if emitted == 0 {
            0.0
        } else {
            1.0 / emitted as f64
        };
        Self {
            tree,
            stored,
            center,
            rotation,
            per_path,
            refused,
        }
    }

    /// Number of photons in the map.
    pub fn len(&self) -> usize {
        self.stored.len()
    }

    /// Whether the map holds no photon.
    pub fn is_empty(&self) -> bool {
        self.stored.is_empty()
    }

    /// Photons refused for not being finite.
    pub fn refused(&self) -> u64 {
        self.refused
    }

    /// Irradiance in W/m2 at `p` on the side of the unit normal `n`, by an
    /// Epanechnikov kernel `2/pi (1 - d^2/r^2) / r^2` over the distance `d` in
    /// the tangent plane, `r` in metres above 0. `keep` may refuse a photon by
    /// its position: where a wall stands between.
    pub fn irradiance(&self, p: DVec3, n: DVec3, r: f64, keep: impl Fn(DVec3) -> bool) -> Gathered {
        let Some(tree) = &self.tree else {
            return Gathered::default();
        };
        let query = (self.rotation * (p - self.center)).as_vec3();
        let normal = (self.rotation * n).as_vec3();
        let normal_code = encode(normal) | BOUNCED;
        let radius = r as f32;
        let r2 = radius * radius;
        if !(r2 > 0.0 && r2.is_finite() && query.is_finite()) {
            return Gathered::default();
        }
        let mut sum = [[0.0f64; 3]; 2];
        let mut visited = 0;
        tree.query(&query.to_array())
            .within::<SquaredEuclidean<f32>>(r2)
            .unsorted()
            .visit(|hit| {
                let stored = &self.stored[hit.item as usize];
                visited += 1;
                let offset = Vec3::from(stored.position) - query;
                let height = offset.dot(normal);
                if height.abs() > SLAB * radius
                    || (stored.normal | BOUNCED != normal_code
                        && decode(stored.normal).dot(normal) < SAME_FACE_COSINE)
                {
                    return;
                }
                let tangential = offset.length_squared() - height * height;
                let k = f64::from((1.0 - tangential / r2).max(0.0));
                // The rotation's transpose is its inverse.
                if k == 0.0 || !keep(p + self.rotation.transpose() * offset.as_dvec3()) {
                    return;
                }
                for (s, f) in sum[(stored.normal & BOUNCED) as usize]
                    .iter_mut()
                    .zip(stored.flux)
                {
                    *s += k * f64::from(f);
                }
            });
        let [irradiance, bounced] = sum.map(|s| Rgb(s) * (FRAC_2_PI * self.per_path / (r * r)));
        Gathered {
            irradiance,
            bounced,
            visited,
        }
    }
}

/// The median of the photons' positions along each axis; of a sample where
/// there are many.
fn median(photons: &[&Photon]) -> DVec3 {
    const SAMPLE: usize = 4096;
    let step = (photons.len() / SAMPLE).max(1);
    let along = |axis: usize| {
        let mut xs: Vec<f64> = photons
            .iter()
            .step_by(step)
            .map(|p| p.position[axis])
            .collect();
        if xs.is_empty() {
            return 0.0;
        }
        let middle = xs.len() / 2;
        *xs.select_nth_unstable_by(middle, f64::total_cmp).1
    };
    DVec3::new(along(0), along(1), along(2))
}

/// The photons in order along a Morton curve; their old order decides between
/// those in one cell.
fn along_curve(photons: &[Stored]) -> Vec<Stored> {
    // The curve's cube spans eight times the mean distance from the median
    // either way, cut into 1024 cells a side; what lies outside counts to the
    // outermost cells. A sum in sequence: it must not depend on threads.
    let taxicab = |p: &Stored| p.position.iter().map(|x| f64::from(x.abs())).sum::<f64>();
    let mean = photons.iter().map(taxicab).sum::<f64>() / photons.len().max(1) as f64;
    let scale = (64.0 / mean.max(f64::MIN_POSITIVE)) as f32;
    let mut keys: Vec<u64> = photons
        .par_iter()
        .enumerate()
        .map(|(i, p)| u64::from(morton(p.position.map(|x| x * scale + 512.0))) << 32 | i as u64)
        .collect();
    keys.par_sort_unstable();
    keys.par_iter()
        .map(|key| photons[(key & 0xffff_ffff) as usize])
        .collect()
}

/// Interleaves the lowest ten bits of three coordinates, clamped to 0..1024.
fn morton(cell: [f32; 3]) -> u32 {
    let spread = |x: f32| {
        // `as` clamps below at zero.
        let mut v = (x as u32).min(1023);
        v = (v | v << 16) & 0x0300_00ff;
        v = (v | v << 8) & 0x0300_f00f;
        v = (v | v << 4) & 0x030c_30c3;
        (v | v << 2) & 0x0924_9249
    };
    spread(cell[0]) | spread(cell[1]) << 1 | spread(cell[2]) << 2
}

/// A rotation whose axes are far from each other's and from the coordinate
/// axes: the unit quaternion of (1, 2, 3, 5), exact arithmetic only.
fn off_axis() -> DMat3 {
    DMat3::from_quat(glam::DQuat::from_xyzw(1.0, 2.0, 3.0, 5.0).normalize())
}

/// A unit vector in 32 bits by the octahedral map (Cigolle et al., JCGT 3(2),
/// 2014); the error is below 1e-4 rad, or 2e-4 with the lowest bit lent away,
/// and it serves a gate only.
fn encode(n: Vec3) -> u32 {
    let n = n / (n.x.abs() + n.y.abs() + n.z.abs());
    let (x, y) = if n.z >= 0.0 {
        (n.x, n.y)
    } else {
        (
            (1.0 - n.y.abs()).copysign(n.x),
            (1.0 - n.x.abs()).copysign(n.y),
        )
    };
    let quantise = |v: f32| ((v.clamp(-1.0, 1.0) * 32767.0).round() as i16 as u16) as u32;
    quantise(x) | (quantise(y) << 16)
}

fn decode(code: u32) -> Vec3 {
    let part = |v: u32| f32::from(v as u16 as i16) / 32767.0;
    let (x, y) = (part(code), part(code >> 16));
    let z = 1.0 - x.abs() - y.abs();
    let fold = (-z).max(0.0);
    Vec3::new(x - fold.copysign(x), y - fold.copysign(y), z).normalize()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sampling::{Purpose, Sequence, warp};

    #[test]
    fn normals_survive_their_code() {
        let seq = Sequence::new(1, Purpose::Pilot, 0, 0);
        for i in 0..2000 {
            let n = warp::sphere(seq.at(i).next_2d()).as_vec3();
            assert!(decode(encode(n)).distance(n) < 1e-4, "{n}");
            for kind in [0, BOUNCED] {
                assert!(
                    decode(encode(n) & !BOUNCED | kind).distance(n) < 2e-4,
                    "{n}"
                );
            }
        }
        for n in [
            Vec3::X,
            Vec3::NEG_X,
            Vec3::Y,
            Vec3::NEG_Y,
            Vec3::Z,
            Vec3::NEG_Z,
        ] {
            assert!(decode(encode(n)).distance(n) < 1e-4, "{n}");
        }
    }

    fn floor_photons(count: u64, half: f64, height: impl Fn(u64) -> f64) -> Vec<Photon> {
        let seq = Sequence::new(5, Purpose::Pilot, 0, 0);
        (0..count)
            .map(|i| {
                let [a, b] = seq.at(i).next_2d();
                Photon {
                    position: DVec3::new((2.0 * a - 1.0) * half, (2.0 * b - 1.0) * half, height(i)),
                    normal: DVec3::Z,
                    flux: Rgb::new(1.0, 0.5, 0.25),
                    bounced: false,
                }
            })
            .collect()
    }

    /// The tree's sum against a loop over all photons.
    #[test]
    fn agrees_with_brute_force() {
        let photons = floor_photons(20_000, 1.0, |i| if i % 3 == 0 { 0.02 } else { 0.0 });
        let map = PhotonMap::new(&photons, 20_000);
        let seq = Sequence::new(6, Purpose::Pilot, 0, 0);
        for i in 0..200 {
            let mut s = seq.at(i);
            let p = DVec3::new(2.0 * s.next_1d() - 1.0, 2.0 * s.next_1d() - 1.0, 0.0);
            let r = 0.02 + 0.2 * s.next_1d();
            let mut sum = 0.0;
            for ph in &photons {
                let o = ph.position - p;
                if o.length() <= r && o.z.abs() <= 0.5 * r {
                    sum += 1.0 - (o.x * o.x + o.y * o.y) / (r * r);
                }
            }
            let expected = sum * FRAC_2_PI / (r * r) / 20_000.0;
            let got = map.irradiance(p, DVec3::Z, r, |_| true).irradiance;
            assert!(
                (got[0] - expected).abs() < 2e-4 * expected.max(1e-3),
                "{} against {expected}",
                got[0]
            );
            assert!(
                (got[1] - 0.5 * got[0]).abs() < 1e-12 && (got[2] - 0.25 * got[0]).abs() < 1e-12
            );
        }
    }

    /// Uniform light on a plane: the mean estimate is flux over area for every
    /// radius, away from the edges.
    #[test]
    fn uniform_light_on_a_plane() {
        let photons = floor_photons(1 << 16, 1.0, |_| 0.0);
        let map = PhotonMap::new(&photons, 1 << 16);
        for r in [0.02, 0.1, 0.4] {
            let seq = Sequence::new(9, Purpose::Pilot, 0, 0);
            let n = 400;
            let mean: f64 = (0..n)
                .map(|i| {
                    let [a, b] = seq.at(i).next_2d();
                    let p = DVec3::new(a - 0.5, b - 0.5, 0.0);
                    map.irradiance(p, DVec3::Z, r, |_| true).irradiance[0]
                })
                .sum::<f64>()
                / n as f64;
            // One watt a photon, one path each: 1 W over 4 m2. The bound is
            // three standard errors of independent photons; low-discrepancy
            // ones do better.
            let se = 0.25
                * (4.0 / (3.0 * f64::from(1 << 16) * 0.25 * std::f64::consts::PI * r * r)).sqrt()
                / (n as f64).sqrt().min(0.5 / r);
            assert!(
                (mean - 0.25).abs() < 3.0 * se,
                "radius {r}: {mean}, se {se}"
            );
        }
    }

    #[test]
    fn the_other_side_and_other_faces_get_nothing() {
        let map = PhotonMap::new(&floor_photons(10_000, 1.0, |_| 0.0), 10_000);
        assert!(
            map.irradiance(DVec3::ZERO, DVec3::Z, 0.1, |_| true)
                .irradiance[0]
                > 0.0
        );
        assert!(
            map.irradiance(DVec3::ZERO, DVec3::NEG_Z, 0.1, |_| true)
                .irradiance
                .is_black(),
            "back side"
        );
        assert!(
            map.irradiance(DVec3::ZERO, DVec3::X, 0.1, |_| true)
                .irradiance
                .is_black(),
            "a wall on the floor"
        );
        assert!(
            map.irradiance(DVec3::new(0.0, 0.0, 0.08), DVec3::Z, 0.1, |_| true)
                .irradiance
                .is_black(),
            "a shelf above"
        );
    }

    /// A few photons at the far end of an unbounded plane leave the others
    /// where they are.
    #[test]
    fn far_photons_do_not_blur_near_ones() {
        let mut photons = floor_photons(20_000, 1.0, |_| 0.0);
        let near = PhotonMap::new(&photons, 20_000);
        for (i, far) in [1e6, -3e7, 1e9].into_iter().enumerate() {
            photons[1000 * (i + 1)].position.x = far;
        }
        let all = PhotonMap::new(&photons, 20_000);
        for i in 0..100u64 {
            let [a, b] = Sequence::new(8, Purpose::Pilot, 0, 0).at(i).next_2d();
            let p = DVec3::new(1.6 * a - 0.8, 1.6 * b - 0.8, 0.0);
            let [near, all] = [&near, &all].map(|m| m.irradiance(p, DVec3::Z, 0.05, |_| true));
            // At most three of the photons in reach were taken away.
            let one = FRAC_2_PI / (0.05 * 0.05) / 20_000.0;
            let difference = near.irradiance[0] - all.irradiance[0];
            assert!(
                (-1e-4..=3.0 * one).contains(&difference),
                "{} became {}",
                near.irradiance[0],
                all.irradiance[0]
            );
        }
    }

    #[test]
    fn degenerate_sets() {
        let one = |p: DVec3| Photon {
            position: p,
            normal: DVec3::Z,
            flux: Rgb::WHITE,
            bounced: false,
        };
        assert!(
            PhotonMap::new(&[], 10)
                .irradiance(DVec3::ZERO, DVec3::Z, 1.0, |_| true)
                .irradiance
                .is_black()
        );
        let same = vec![one(DVec3::splat(3.0)); 5000];
        let map = PhotonMap::new(&same, 5000);
        let at = map
            .irradiance(DVec3::splat(3.0), DVec3::Z, 0.5, |_| true)
            .irradiance[0];
        assert!(
            (at - FRAC_2_PI / 0.25).abs() < 1e-9,
            "5000 coincident photons: {at}"
        );
        let bad = [
            one(DVec3::ZERO),
            one(DVec3::new(f64::NAN, 0.0, 0.0)),
            one(DVec3::splat(f64::INFINITY)),
        ];
        let map = PhotonMap::new(&bad, 3);
        assert_eq!((map.len(), map.refused()), (1, 2));
        assert!(
            map.irradiance(DVec3::ZERO, DVec3::Z, f64::NAN, |_| true)
                .irradiance
                .is_black()
        );
    }
}
