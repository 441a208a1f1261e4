//! How the shading normal turns as one moves on a surface.
//!
//! A ray that is reflected or refracted carries its neighbours with it: how
//! they spread follows from the curvature under them (Igehy, *Tracing Ray
//! Differentials*, 1999, section 3.2). Each shape states the derivative of its
//! normal in its own space; an affine map `M` sends normals by `M^-T` and
//! normalises them, and displacements by `M`.

use glam::{DMat3, DVec3};

use super::{Hit, Instance, Shape, Surface, SurfacePoint, Transform, World, shape::Place};
use crate::numeric::VectorPair;

/// How the shading normal changes from place to place on a surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Turning {
    /// A flat surface: it does not.
    Flat,
    /// A triangle of a mesh that is shaded by its own normal: it does not,
    /// within the facet.
    Facet {
        /// Diameter of the facet's incircle, in metres.
        size: f64,
    },
    /// By the same angle in all directions.
    Round {
        /// Angle per length, in radians a metre: one over the radius of a
        /// sphere.
        curvature: f64,
    },
    /// By a linear map of vectors in the tangent plane, in radians a metre.
    General(DMat3),
}

impl Turning {
    /// The facet with these corners.
    pub(super) fn of_facet(v: &[DVec3; 3]) -> Self {
        let (e, f) = (v[1] - v[0], v[2] - v[0]);
        // Four areas over the perimeter; divided first, so that a product of
        // small edges does not vanish.
        let perimeter = e.length() + f.length() + (f - e).length();
        Self::Facet {
            size: 2.0 * e.cross(f / perimeter).length(),
        }
    }

    /// The change of the shading normal for a displacement in metres, to
    /// first order. The displacement lies in the tangent plane of the
    /// geometric normal, the change is perpendicular to the shading normal.
    #[inline]
    pub fn of(&self, displacement: DVec3) -> DVec3 {
        match self {
            Self::Flat | Self::Facet { .. } => DVec3::ZERO,
            Self::Round { curvature } => displacement * *curvature,
            Self::General(map) => *map * displacement,
        }
    }

    /// [`of`](Self::of) for two displacements.
    #[inline]
    pub fn of_pair(&self, displacements: VectorPair) -> VectorPair {
        match self {
            Self::Flat | Self::Facet { .. } => VectorPair::ZERO,
            Self::Round { curvature } => displacements * *curvature,
            Self::General(map) => displacements.under(map),
        }
    }

    /// That of the surface on which a function is zero, from its gradient and
    /// its second derivative there, towards the side on which it is positive.
    pub(super) fn of_level(gradient: DVec3, second: DMat3) -> Self {
        let length = gradient.length();
        let n = gradient / length;
        // Normalising takes away what is along the normal.
        let map = (second - outer(n, second.transpose() * n)) * (1.0 / length);
        if map.is_finite() {
            Self::General(map)
        } else {
            // The tip of a cone has no normal that could turn.
            Self::Flat
        }
    }

    /// The turning of the opposite normal.
    #[must_use]
    pub(super) fn reversed(self) -> Self {
        match self {
            Self::Flat | Self::Facet { .. } => self,
            Self::Round { curvature } => Self::Round {
                curvature: -curvature,
            },
            Self::General(map) => Self::General(-map),
        }
    }

    /// A turning in object space, seen in the world at a point with unit
    /// shading normal `ns`. The size of a facet has no image under a map: it
    /// stays.
    pub(super) fn under(self, m: &Transform, ns: DVec3) -> Self {
        match (self, m.similarity()) {
            (Self::Flat | Self::Facet { .. }, _) => self,
            (Self::Round { curvature }, Some(scale)) => Self::Round {
                curvature: curvature / scale,
            },
            (Self::Round { curvature }, None) => {
                Self::General(m.turning(DMat3::from_diagonal(DVec3::splat(curvature)), ns))
            }
            (Self::General(map), _) => Self::General(m.turning(map, ns)),
        }
    }
}

/// The matrix `a b^T`.
#[inline]
pub(super) fn outer(a: DVec3, b: DVec3) -> DMat3 {
    DMat3::from_cols(a * b.x, a * b.y, a * b.z)
}

impl World {
    /// How the shading normal `point.ns` turns at a hit, of which `point` is
    /// the [`surface`](Self::surface). It describes the normal as it stands
    /// there, whatever the side from which it is seen.
    #[inline]
    pub fn turning(&self, hit: &Hit, point: &SurfacePoint) -> Turning {
        let place = Place {
            p: point.p,
            ng: point.ng,
            ns: point.ns,
        };
        self.instances()[hit.surface.instance as usize].turning(hit.surface.part, hit.uv, place)
    }
}

impl Instance {
    /// How the shading normal turns at a place of a part, all in world space.
    #[inline]
    pub(super) fn turning(&self, part: u32, uv: [f64; 2], place: Place) -> Turning {
        let shape = &self.shape;
        let Some(m) = &self.transform else {
            return shape.turning(part, uv, || place);
        };
        let own = shape.turning(part, uv, || place.back(m));
        let Shape::Mesh(mesh) = shape else {
            return own.under(m, place.ns);
        };
        // Normals that the map has driven apart were replaced by the facet's.
        let replaced = || {
            let (ng, ns) = mesh.normals(part, uv);
            !m.agree(ng, ns)
        };
        match own {
            Turning::General(_) if place.ns != place.ng || !replaced() => own.under(m, place.ns),
            _ => Turning::of_facet(&mesh.triangle(part).map(|p| m.point(p))),
        }
    }
}
