//! Photons whose kernels reach about equally far, in a kd-tree.
//!
//! This is the only file that knows the kd-tree crate. Positions are `f32`
//! relative to the median of the class: small kernels lie close together, and
//! so are stored finely. Long ellipses enter as several *spans* along their
//! major axis, each a point of the tree: a search as wide as the ellipse is
//! long would meet many that do not reach the query.

use std::f32::consts::SQRT_2;

use glam::{DMat3, DVec3, Vec3};
use kiddo::{Eytzinger, FlatVec, KdTree, SquaredEuclidean};
use rayon::prelude::*;

use super::{Photon, normal::encode, order};

type Tree = KdTree<f32, u32, Eytzinger, FlatVec<f32, u32, 3, 32>, 3, 32>;

/// Photons whose surface normal differs more than this from the query's
/// (cosine) lie on another face.
pub(super) const SAME_FACE_COSINE: f32 = 0.7;

/// A photon is taken to lie on the query's surface if the way to it leaves
/// the mean of the two tangent planes by no more than this part of its length
/// (on a sphere it does not leave it at all), or of the kernel's minor
/// semi-axis.
pub(super) const SLAB: f32 = 0.25;

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

/// A photon at rest, 60 bytes.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Stored {
    pub(super) position: [f32; 3],
    pub(super) flux: [f32; 3],
    /// Area of its sheet of light.
    pub(super) sheet: f32,
    /// Unit vector of the major axis.
    pub(super) axis: [f32; 3],
    /// Length of the major semi-axis; 0 for photons without a footprint.
    pub(super) major: f32,
    /// Length of the minor semi-axis.
    pub(super) minor: f32,
    /// Distance to a fold on the side of `-normal x axis`.
    pub(super) fold: f32,
    /// The surface's normal, in code.
    pub(super) normal: u32,
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
#[derive(Clone, Copy, Debug)]
pub(super) struct Search {
    /// The query's normal in the map's frame.
    pub(super) normal: Vec3,
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
    /// Reach over that of the largest kernels asked for, at most.
    spread: f32,
    /// The box around all spans.
    low: Vec3,
    high: Vec3,
}

impl Class {
    /// Sorts photons into classes. Their footprints are multiplied by
    /// `shrink`.
    pub(super) fn sort(photons: &[&Photon], rotation: DMat3, shrink: f64) -> Vec<Self> {
        let reach_of = |photon: &Photon| {
            photon.footprint.map(|f| {
                let (major, minor) = f.kernel(shrink);
                reach(major, minor, MOST_SPANS)
            })
        };
        // By the exponent of the reach over the largest, so that the work is the
        // same at any scale; without a footprint below all others.
        let reaches: Vec<Option<f64>> = photons.par_iter().map(|p| reach_of(p)).collect();
        let largest = reaches
            .iter()
            .flatten()
            .fold(f64::MIN_POSITIVE, |a, &b| a.max(b));
        let mut by_size: Vec<(i32, Vec<&Photon>)> = Vec::new();
        for (photon, reach) in photons.iter().zip(reaches) {
            let key = reach.map_or(i32::MIN, |reach| exponent(reach / largest));
            match by_size.binary_search_by_key(&key, |c| c.0) {
                Ok(i) => by_size[i].1.push(photon),
                Err(i) => by_size.insert(i, (key, vec![photon])),
            }
        }
        let fewest = FEWEST.max(photons.len() / SMALLEST_PART);
        let mut classes: Vec<Vec<&Photon>> = Vec::new();
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
            classes.push(members);
        }
        Self::all(&classes, rotation, shrink, MOST_SPANS)
    }

    /// Classes of these photons, side by side.
    fn all(classes: &[Vec<&Photon>], rotation: DMat3, shrink: f64, most_spans: u32) -> Vec<Self> {
        let classes = classes.par_iter().filter(|members| !members.is_empty());
        classes
            .filter_map(|members| Self::new(members, rotation, shrink, most_spans))
            .collect()
    }

    /// All photons in one class, for kernels that queries will cut to a size
    /// below most of theirs: classes would be searched equally far.
    pub(super) fn of_cut(photons: &[&Photon], rotation: DMat3, shrink: f64) -> Vec<Self> {
        let (sized, blind): (Vec<&Photon>, Vec<&Photon>) =
            photons.iter().partition(|p| p.footprint.is_some());
        Self::all(&[blind, sized], rotation, shrink, 1)
    }

    fn new(photons: &[&Photon], rotation: DMat3, shrink: f64, most_spans: u32) -> Option<Self> {
        let center = rotation * order::median(photons);
        // The same numbers as decided the class: rotated axes would be rounded
        // differently.
        let kernel = |photon: &Photon| photon.footprint.map(|f| f.kernel(shrink));
        let stored: Vec<Stored> = photons
            .par_iter()
            .map(|photon| {
                let axis = photon.footprint.map_or(DVec3::ZERO, |f| unit(f.major));
                let (major, minor) = kernel(photon).unwrap_or_default();
                Stored {
                    position: (rotation * photon.position - center).as_vec3().to_array(),
                    flux: photon.flux.0.map(|c| c as f32),
                    sheet: photon.sheet as f32,
                    axis: (rotation * axis).as_vec3().to_array(),
                    major: major as f32,
                    minor: minor as f32,
                    fold: photon.footprint.map_or(f64::INFINITY, |f| f.fold) as f32,
                    normal: encode((rotation * photon.normal).as_vec3()),
                }
            })
            .collect();
        let spans_of = |(number, photon): (usize, &&Photon)| {
            let (major, minor) = kernel(photon).unwrap_or_default();
            let axis = photon.footprint.map_or(DVec3::ZERO, |f| unit(f.major));
            let (position, axis) = (rotation * photon.position - center, rotation * axis);
            let count = span_count(major, minor, most_spans);
            (0..count).map(move |i| {
                let along = major * (f64::from(2 * i + 1) / f64::from(count) - 1.0);
                Span {
                    position: (position + axis * along).as_vec3().to_array(),
                    item: (number as u32) << 4 | i,
                }
            })
        };
        let spans: Vec<Span> = photons
            .par_iter()
            .enumerate()
            .flat_map_iter(spans_of)
            .collect();
        let farthest = photons
            .par_iter()
            .filter_map(|photon| kernel(photon))
            .map(|(major, minor)| reach(major, minor, most_spans))
            .reduce(|| 0.0, f64::max);
        let corner = |pick: fn(Vec3, Vec3) -> Vec3| {
            spans
                .par_iter()
                .map(|s| Vec3::from(s.position))
                .reduce_with(pick)
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
            spread: if most_spans > 1 { SQRT_2 } else { 1.0 },
            low,
            high,
        })
    }

    /// A point in the frame of the class.
    pub(super) fn local(&self, p: DVec3) -> Vec3 {
        (p - self.center).as_vec3()
    }

    /// The photons of the class.
    pub(super) fn photons(&self) -> &[Stored] {
        &self.photons
    }

    /// Puts the numbers of all photons whose kernels may reach a point within
    /// `margin` of `p`, for queries that are bounded by `search`, into
    /// `numbers`, in order; how many candidates there were for it.
    pub(super) fn find(
        &self,
        p: DVec3,
        search: &Search,
        margin: f32,
        numbers: &mut Vec<u32>,
    ) -> u32 {
        numbers.clear();
        let center = self.local(p);
        let squared = if self.reach == 0.0 {
            search.blind * search.blind
        } else {
            // Widened kernels are rounder, not longer.
            (self.reach * self.reach + search.least * search.least)
                .min((self.spread * search.most).powi(2))
        };
        let squared = if margin > 0.0 {
            // With room for rounding.
            (squared.sqrt() + margin).powi(2) * (1.0 + 1e-5)
        } else {
            squared
        };
        let outside = center - center.clamp(self.low, self.high);
        // Also where something is not a number.
        let within = outside.length_squared() < squared && squared.is_finite();
        if !within {
            return 0;
        }
        let mut visited = 0;
        self.tree
            .query(&center.to_array())
            .within::<SquaredEuclidean<f32>>(squared)
            .unsorted()
            .visit(|hit| {
                visited += 1;
                let number = hit.item >> 4;
                if self.photons[number as usize].may_reach(center, search, margin) {
                    numbers.push(number);
                }
            });
        numbers.sort_unstable();
        // An ellipse of several spans may be found several times.
        numbers.dedup();
        visited
    }
}

impl Stored {
    /// Semi-axes of the kernel within a query's bounds.
    #[inline]
    fn semi_axes(&self, search: &Search) -> (f32, f32) {
        if self.major > 0.0 {
            let bounded = |axis: f32| axis.clamp(search.least, search.most);
            (bounded(self.major), bounded(self.minor))
        } else {
            (search.blind, search.blind)
        }
    }

    /// Whether the kernel may reach a point within `margin` of `center`.
    pub(super) fn may_reach(&self, center: Vec3, search: &Search, margin: f32) -> bool {
        // Of what the slab lets through, height^2 <= SLAB^2 (a^2 + b^2 + height^2)
        // is the highest.
        const HEIGHT_SQ: f32 = SLAB * SLAB / (1.0 - SLAB * SLAB);
        let (major, minor) = self.semi_axes(search);
        let offset = Vec3::from(self.position) - center;
        let along = offset.dot(Vec3::from(self.axis));
        let from_axis = (offset.length_squared() - along * along).max(0.0).sqrt();
        let (a2, b2) = (major * major, minor * minor);
        along.abs() <= major + margin && from_axis <= (b2 + HEIGHT_SQ * (a2 + b2)).sqrt() + margin
    }
}

/// A vector's direction; any where it has none.
fn unit(v: DVec3) -> DVec3 {
    v.try_normalize().unwrap_or(DVec3::X)
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
