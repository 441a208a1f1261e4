//! Photons whose kernels reach about equally far, in a kd-tree.
//!
//! This is the only file that knows the kd-tree crate. Positions are `f32`
//! relative to the median of the class: small kernels lie close together, and
//! so are stored finely. Long ellipses enter as several *spans* along their
//! major axis, each a point of the tree: a search as wide as the ellipse is
//! long would meet many that do not reach the query. Each query belongs to one
//! span of an ellipse, so it finds it once.

use std::f64::consts::FRAC_2_PI;

use glam::{DMat3, DVec3, Vec3};
use kiddo::{Eytzinger, FlatVec, KdTree, SquaredEuclidean};

use super::{
    Gathered, Photon,
    normal::{decode, encode},
    order,
};

type Tree = KdTree<f32, u32, Eytzinger, FlatVec<f32, u32, 3, 32>, 3, 32>;

/// Photons whose surface normal differs more than this from the query's
/// (cosine) lie on another face.
const SAME_FACE_COSINE: f32 = 0.7;

/// A photon is taken to lie on the query's surface if the way to it leaves
/// the mean of the two tangent planes by no more than this part of its length
/// (on a sphere it does not leave it at all), or of the kernel's minor
/// semi-axis.
const SLAB: f32 = 0.25;

/// Most spans of an ellipse: an odd number, so that one is in its middle.
const MOST_SPANS: u32 = 15;

/// Half-length of a span over the minor semi-axis, about.
const SPAN: f64 = 1.5;

/// Classes with fewer photons, or a smaller part of all, are joined with the
/// next wider one: every tree that a query has to enter costs as much as a few
/// dozen candidates.
const FEWEST: usize = 1024;
const SMALLEST_PART: usize = 8;

/// Bytes that a photon takes here, with four spans in the tree; long ellipses
/// have more.
pub(super) const BYTES_PER_PHOTON: u64 = size_of::<Stored>() as u64 + 4 * 36;

/// A photon at rest, 56 bytes.
#[derive(Clone, Copy, Debug)]
struct Stored {
    position: [f32; 3],
    flux: [f32; 3],
    /// Unit vector of the major axis.
    axis: [f32; 3],
    /// Length of the major semi-axis; 0 for photons without a footprint.
    major: f32,
    /// Length of the minor semi-axis.
    minor: f32,
    /// The surface's normal.
    normal: u32,
    /// Number of spans.
    spans: u32,
}

/// A point of the tree.
#[derive(Clone, Copy, Debug)]
struct Span {
    position: [f32; 3],
    /// The photon's number times 16, plus that of the span.
    item: u32,
}

/// A kernel.
#[derive(Clone, Copy, Debug)]
pub struct Ellipse {
    /// Unit vector of the major axis, in the tangent plane.
    pub axis: DVec3,
    /// Major semi-axis, metres.
    pub major: f64,
    /// Minor semi-axis, metres.
    pub minor: f64,
}

/// What a query says to every class, lengths in metres.
pub(super) struct Search {
    /// The query's normal in the map's frame.
    pub(super) normal: Vec3,
    /// Its code.
    pub(super) code: u32,
    /// Bounds of the semi-axes.
    pub(super) least: f32,
    pub(super) most: f32,
    /// Kernel radius of photons without a footprint.
    pub(super) blind: f32,
}

/// Photons of one class.
pub(super) struct Class {
    tree: Tree,
    photons: Vec<Stored>,
    center: DVec3,
    /// No photon's kernel reaches further from the nearest of its spans; 0 for
    /// photons without a footprint.
    reach: f32,
    /// Squared reach over that of the largest kernels asked for, at most.
    spread: f32,
    /// The box around all spans.
    low: Vec3,
    high: Vec3,
}

impl Class {
    /// Sorts photons into classes. Their footprints are multiplied by
    /// `shrink`.
    pub(super) fn sort(photons: &[&Photon], rotation: DMat3, shrink: f64) -> Vec<Self> {
        // By the exponent of the reach; without a footprint below all others.
        let mut by_size: Vec<(i32, Vec<&Photon>)> = Vec::new();
        for photon in photons {
            let key = photon.footprint.map_or(i32::MIN, |f| {
                exponent(reach(
                    f.major.length() * shrink,
                    f.minor * shrink,
                    MOST_SPANS,
                ))
            });
            match by_size.binary_search_by_key(&key, |c| c.0) {
                Ok(i) => by_size[i].1.push(photon),
                Err(i) => by_size.insert(i, (key, vec![photon])),
            }
        }
        let fewest = FEWEST.max(photons.len() / SMALLEST_PART);
        let mut classes = Vec::new();
        let mut few: Vec<&Photon> = Vec::new();
        let last = by_size.len().saturating_sub(1);
        for (i, (key, mut members)) in by_size.into_iter().enumerate() {
            if key > i32::MIN {
                members.append(&mut few);
                if members.len() < fewest && i < last {
                    few = members;
                    continue;
                }
            }
            classes.extend(Self::new(&members, rotation, shrink, MOST_SPANS));
        }
        classes
    }

    /// All photons in one class, for kernels that queries will cut to a size
    /// below most of theirs: classes would be searched equally far.
    pub(super) fn of_cut(photons: &[&Photon], rotation: DMat3, shrink: f64) -> Vec<Self> {
        let (sized, blind): (Vec<&Photon>, Vec<&Photon>) =
            photons.iter().partition(|p| p.footprint.is_some());
        [blind, sized]
            .iter()
            .filter(|members| !members.is_empty())
            .filter_map(|members| Self::new(members, rotation, shrink, 1))
            .collect()
    }

    fn new(photons: &[&Photon], rotation: DMat3, shrink: f64, most_spans: u32) -> Option<Self> {
        let center = rotation * order::median(photons);
        let mut stored = Vec::with_capacity(photons.len());
        let mut spans = Vec::with_capacity(photons.len());
        let mut farthest = 0.0f64;
        for photon in photons {
            let position = rotation * photon.position - center;
            // The same numbers as decided the class: rotated axes would be
            // rounded differently.
            let (axis, length, minor) = photon.footprint.map_or((DVec3::ZERO, 0.0, 0.0), |f| {
                let axis = f.major.try_normalize().unwrap_or(DVec3::X);
                (rotation * axis, f.major.length() * shrink, f.minor * shrink)
            });
            farthest = farthest.max(reach(length, minor, most_spans));
            let spans_of_it = span_count(length, minor, most_spans);
            for i in 0..spans_of_it {
                let along = length * (f64::from(2 * i + 1) / f64::from(spans_of_it) - 1.0);
                spans.push(Span {
                    position: (position + axis * along).as_vec3().to_array(),
                    item: (stored.len() as u32) << 4 | i,
                });
            }
            stored.push(Stored {
                position: position.as_vec3().to_array(),
                flux: photon.flux.0.map(|c| c as f32),
                axis: axis.as_vec3().to_array(),
                major: length as f32,
                minor: minor as f32,
                normal: encode((rotation * photon.normal).as_vec3()),
                spans: spans_of_it,
            });
        }
        let corner = |pick: fn(Vec3, Vec3) -> Vec3| {
            spans
                .iter()
                .map(|s| Vec3::from(s.position))
                .reduce(pick)
                .unwrap_or(Vec3::ZERO)
        };
        let (low, high) = (corner(Vec3::min), corner(Vec3::max));
        // The builder refuses nothing that is finite and indexable by u32, and
        // the budget of a pass keeps the count far below 2^28.
        let tree =
            Tree::new_from_source_parallel(&spans, |s, axis| s.position[axis], |_, s| s.item)
                .ok()?;
        Some(Self {
            tree,
            photons: stored,
            center,
            // Rounded up, with the rounding of the spans' places.
            reach: (farthest * (1.0 + 1e-6)) as f32,
            // The middle span and its neighbours, or only the one.
            spread: if most_spans > 1 { 2.0 } else { 1.0 },
            low,
            high,
        })
    }

    /// Adds the flux density of all kernels that reach `p`.
    pub(super) fn visit(
        &self,
        p: DVec3,
        search: &Search,
        weigh: &impl Fn(Vec3, &Ellipse) -> f64,
        sum: &mut [f64; 3],
        gathered: &mut Gathered,
    ) {
        let query = (p - self.center).as_vec3();
        let squared = if self.reach == 0.0 {
            search.blind * search.blind
        } else {
            // Widened kernels are rounder, not longer.
            (self.reach * self.reach + search.least * search.least)
                .min(self.spread * search.most * search.most)
        };
        let outside = query - query.clamp(self.low, self.high);
        // Also where something is not a number.
        let within = outside.length_squared() < squared && squared.is_finite();
        if !within {
            return;
        }
        self.tree
            .query(&query.to_array())
            .within::<SquaredEuclidean<f32>>(squared)
            .unsorted()
            .visit(|hit| {
                gathered.visited += 1;
                let photon = &self.photons[(hit.item >> 4) as usize];
                let Some((k, offset, ellipse)) = photon.kernel(query, hit.item & 15, search) else {
                    return;
                };
                let k = k * weigh(offset, &ellipse);
                if k > 0.0 {
                    gathered.accepted += 1;
                    for (s, f) in sum.iter_mut().zip(photon.flux) {
                        *s += k * f64::from(f);
                    }
                }
            });
    }
}

impl Stored {
    /// The kernel's height at the query in 1/m2, with the offset to the photon,
    /// if it reaches the query and the query belongs to this span.
    #[inline]
    fn kernel(&self, query: Vec3, span: u32, search: &Search) -> Option<(f64, Vec3, Ellipse)> {
        let offset = Vec3::from(self.position) - query;
        let (major, minor) = if self.major > 0.0 {
            let bounded = |axis: f32| axis.clamp(search.least, search.most);
            (bounded(self.major), bounded(self.minor))
        } else {
            (search.blind, search.blind)
        };
        let along = offset.dot(Vec3::from(self.axis));
        if along.abs() >= major {
            return None;
        }
        let mut height = offset.dot(search.normal);
        if self.normal != search.code {
            let normal = decode(self.normal);
            if normal.dot(search.normal) < SAME_FACE_COSINE {
                return None;
            }
            height = 0.5 * (height + offset.dot(normal));
        }
        let squared = offset.length_squared();
        if height * height > SLAB * SLAB * squared.max(minor * minor) {
            return None;
        }
        let across = (squared - height * height - along * along).max(0.0);
        let q = along * along / (major * major) + across / (minor * minor);
        if q >= 1.0 || self.span_of(-along) != span {
            return None;
        }
        let ellipse = Ellipse {
            axis: Vec3::from(self.axis).as_dvec3(),
            major: f64::from(major),
            minor: f64::from(minor),
        };
        let k = FRAC_2_PI * f64::from(1.0 - q) / (ellipse.major * ellipse.minor);
        Some((k, offset, ellipse))
    }

    /// The span to which a place along the major axis belongs.
    #[inline]
    fn span_of(&self, along: f32) -> u32 {
        if self.spans == 1 {
            return 0;
        }
        // `as` clamps below at zero.
        let i = (along / self.major + 1.0) * (0.5 * self.spans as f32);
        (i as u32).min(self.spans - 1)
    }
}

/// The number of spans of an ellipse: odd.
fn span_count(major: f64, minor: f64, most: u32) -> u32 {
    // One span for any ellipse that is not a few times longer than wide;
    // `as` saturates.
    let halves = (0.5 * major / (SPAN * minor)) as u32;
    2 * halves.min(most / 2) + 1
}

/// How far a kernel reaches from the nearest of its spans.
fn reach(major: f64, minor: f64, most_spans: u32) -> f64 {
    let count = span_count(major, minor, most_spans);
    if count == 1 {
        return major;
    }
    let half = major / f64::from(count);
    (half * half + minor * minor).sqrt()
}

/// `floor(log2 x)` for positive, normal `x`.
fn exponent(x: f64) -> i32 {
    (x.to_bits() >> 52) as i32 - 1023
}
