//! The photon map: photons in kd-trees by the size of their footprint, asked
//! for irradiance.
//!
//! A photon's kernel is an ellipse in the tangent plane of the surface on
//! which it landed. A query must find every kernel that reaches it, so the
//! photons are kept in *classes* whose kernels reach equally far up to a factor
//! of two, each with a tree of its own: a search never has to be as wide as the
//! widest kernel of all. Light that a diffuse surface reflected after it was a
//! caustic is kept apart from caustics. The answer depends on the photons
//! alone, not on threads.

mod block;
mod class;
mod normal;
mod order;
#[cfg(test)]
mod tests;
mod vicinity;

use glam::{DMat3, DVec3};
use rayon::prelude::*;

use crate::{geometry::points::off_axis, spectrum::Rgb};

use super::Photon;

pub use class::Ellipse;
use class::{Class, Search};
pub use vicinity::Vicinity;

/// Memory that a stored photon needs while its pass is built, in bytes: the
/// traced record (twice, while chunks are joined), references to it, and what
/// a class keeps of it. The `memory` bench measures the peak.
pub const BYTES_PER_PHOTON: u64 = 2 * size_of::<Photon>() as u64 + 24 + class::BYTES_PER_PHOTON;

/// How wide the kernels are that a gather point asks for, in metres.
#[derive(Clone, Copy, Debug)]
pub struct Kernels {
    /// Smallest semi-axis: kernels narrower than what the camera resolves are
    /// widened to it.
    pub least: f64,
    /// Largest semi-axis of caustics.
    pub most: f64,
    /// Largest semi-axis of light reflected after it was a caustic.
    pub most_bounced: f64,
    /// Radius where a photon has no footprint.
    pub blind: f64,
    /// Whether caustics are asked for, or only such reflected light.
    pub caustics: bool,
    /// Distance to the next gather points; 0 where none is near.
    pub spacing: f64,
}

impl Kernels {
    /// No kernel that reaches the point is longer than this.
    pub fn farthest(&self) -> f64 {
        let most = if self.caustics { self.most } else { 0.0 };
        most.max(self.most_bounced).max(self.blind)
    }
}

/// What a gather point asks for.
#[derive(Clone, Copy, Debug)]
pub struct Query {
    /// The point.
    pub p: DVec3,
    /// Unit normal on the side from which it is seen.
    pub n: DVec3,
    /// The kernels' sizes.
    pub kernels: Kernels,
}

impl Query {
    /// What every class is asked for caustics and for reflected light, in the
    /// frame of the map.
    fn searches(&self, rotation: DMat3) -> [Search; 2] {
        let normal = (rotation * self.n).as_vec3();
        let k = &self.kernels;
        [k.most, k.most_bounced].map(|most| Search {
            normal,
            least: k.least.min(most) as f32,
            most: most as f32,
            blind: k.blind as f32,
        })
    }
}

/// The answer to a density query.
#[derive(Clone, Copy, Debug, Default)]
pub struct Gathered {
    /// Irradiance in W/m2 by light that came from its source through specular
    /// steps alone.
    pub irradiance: Rgb,
    /// Irradiance in W/m2 by light of which a diffuse surface had made such a
    /// caustic before it reflected it here.
    pub bounced: Rgb,
    /// What kernels of half and of a quarter of the area find of the same
    /// photons, over what the kernels themselves find: of each kind of light,
    /// 1 where there is none. Zero if it was not to be found out.
    pub narrower: [[f64; 2]; 2],
    /// Density of the photons' sheets, a number without a unit: in the mean over
    /// photons as many as there are ways by which the light of one point of a source
    /// (of one direction of a sun) comes to the gather point through mirrors and glass,
    /// reflections in glass not counted; for a source with extent the mean over it. A
    /// whole number away from the rims of light, and from folds and half-shadows.
    pub sheets: f64,
    /// The same of kernels of half and of a quarter of the area. Zero if it was not to
    /// be found out.
    pub narrower_sheets: [f64; 2],
    /// Candidates that trees offered: the work of searching.
    pub visited: u32,
    /// Kernels evaluated.
    pub tested: u32,
    /// Photons whose kernels reached the point.
    pub accepted: u32,
}

/// The photons of one pass, ready to be asked.
pub struct PhotonMap {
    caustics: Vec<Class>,
    bounced: Vec<Class>,
    rotation: DMat3,
    per_path: f64,
    refused: u64,
    stored: usize,
}

impl PhotonMap {
    /// Builds the map of the photons of `emitted` paths. `shrink` is the
    /// factor on all footprints, 1 in the first round. Photons that are not
    /// finite are refused and counted.
    pub fn new(photons: &[Photon], emitted: u64, shrink: f64) -> Self {
        Self::build(photons, emitted, shrink, Class::of_cut)
    }

    /// The same for queries that do not cut the kernels of light which was
    /// reflected after it was a caustic.
    pub fn with_whole_kernels(photons: &[Photon], emitted: u64) -> Self {
        Self::build(photons, emitted, 1.0, Class::sort)
    }

    fn build(
        photons: &[Photon],
        emitted: u64,
        shrink: f64,
        of_bounced: fn(&[&Photon], DMat3, f64) -> Vec<Class>,
    ) -> Self {
        let rotation = off_axis();
        let mut kept: Vec<&Photon> = photons
            .par_iter()
            .filter(|p| p.position.is_finite() && p.flux.is_finite())
            .collect();
        let center = order::median(&kept);
        order::sort_along_curve(&mut kept, center);
        let (bounced, caustics): (Vec<&Photon>, Vec<&Photon>) =
            kept.par_iter().partition(|p| p.bounced);
        let (caustics, bounced) = rayon::join(
            || Class::sort(&caustics, rotation, shrink),
            || of_bounced(&bounced, rotation, shrink),
        );
        Self {
            caustics,
            bounced,
            rotation,
            per_path: if emitted == 0 {
                0.0
            } else {
                1.0 / emitted as f64
            },
            refused: (photons.len() - kept.len()) as u64,
            stored: kept.len(),
        }
    }

    /// Number of photons in the map.
    pub fn len(&self) -> usize {
        self.stored
    }

    /// Whether the map holds no photon.
    pub fn is_empty(&self) -> bool {
        self.stored == 0
    }

    /// Photons refused for not being finite.
    pub fn refused(&self) -> u64 {
        self.refused
    }

    /// Irradiance in W/m2 at a single point; see [`Vicinity::irradiance`].
    pub fn irradiance(
        &self,
        query: &Query,
        weigh: impl Fn(DVec3, &Ellipse) -> [f64; 3],
    ) -> Gathered {
        Vicinity::new(self).irradiance(query, || 0.0, weigh)
    }

    /// All classes, those of caustics first.
    fn classes(&self) -> impl Iterator<Item = &Class> {
        self.caustics.iter().chain(&self.bounced)
    }
}
