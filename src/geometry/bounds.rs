//! Boxes and spheres that contain things.

use glam::DVec3;

use crate::numeric::gamma;

/// An axis-aligned box, in metres. A box whose `min` exceeds its `max` on an
/// axis is empty.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Aabb {
    /// The corner of smallest coordinates.
    pub min: DVec3,
    /// The corner of largest coordinates.
    pub max: DVec3,
}

impl Aabb {
    /// The box that contains nothing; neutral for [`union`](Self::union).
    pub const EMPTY: Self = Self {
        min: DVec3::INFINITY,
        max: DVec3::NEG_INFINITY,
    };

    /// The smallest box around the points; empty if there are none.
    pub fn around(points: impl IntoIterator<Item = DVec3>) -> Self {
        points.into_iter().fold(Self::EMPTY, Self::grown)
    }

    /// True if the box contains no point.
    pub fn is_empty(&self) -> bool {
        !self.min.cmple(self.max).all()
    }

    /// The smallest box around both.
    #[must_use]
    pub fn union(self, other: Self) -> Self {
        Self {
            min: self.min.min(other.min),
            max: self.max.max(other.max),
        }
    }

    /// What both have in common; empty if that is nothing.
    #[must_use]
    pub fn intersection(self, other: Self) -> Self {
        Self {
            min: self.min.max(other.min),
            max: self.max.min(other.max),
        }
    }

    /// The smallest box around this one and the point.
    #[must_use]
    pub fn grown(self, point: DVec3) -> Self {
        Self {
            min: self.min.min(point),
            max: self.max.max(point),
        }
    }

    /// The box with every face moved outward by `margin` metres.
    #[must_use]
    pub fn padded(self, margin: f64) -> Self {
        Self {
            min: self.min - DVec3::splat(margin),
            max: self.max + DVec3::splat(margin),
        }
    }

    /// The middle of the box.
    pub fn center(&self) -> DVec3 {
        // Halved first, so that the sum cannot overflow.
        self.min * 0.5 + self.max * 0.5
    }

    /// From the middle to the corner of largest coordinates.
    pub fn half_diagonal(&self) -> DVec3 {
        self.max * 0.5 - self.min * 0.5
    }

    /// The eight corners.
    pub fn corners(&self) -> [DVec3; 8] {
        std::array::from_fn(|i| {
            let pick = |axis: usize| {
                if i >> axis & 1 == 0 {
                    self.min[axis]
                } else {
                    self.max[axis]
                }
            };
            DVec3::new(pick(0), pick(1), pick(2))
        })
    }

    /// The sphere through the corners.
    pub fn bounding_sphere(&self) -> BoundingSphere {
        BoundingSphere {
            center: self.center(),
            // Difference, two products, two sums and the root round.
            radius: self.half_diagonal().length() * (1.0 + gamma(6)),
        }
    }

    /// True if the boxes have a point in common.
    pub fn overlaps(&self, other: &Self) -> bool {
        self.min.cmple(other.max).all() && other.min.cmple(self.max).all()
    }

    /// True if the point lies inside or on the box.
    pub fn contains(&self, point: DVec3) -> bool {
        self.min.cmple(point).all() && point.cmple(self.max).all()
    }

    /// The largest coordinate by magnitude, in metres.
    pub fn max_abs(&self) -> f64 {
        self.min.abs().max(self.max.abs()).max_element()
    }
}

/// A sphere around something, in metres.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BoundingSphere {
    /// Centre.
    pub center: DVec3,
    /// Radius.
    pub radius: f64,
}

impl BoundingSphere {
    /// A sphere around points, centred in their box: at most sqrt(3) times
    /// larger than the smallest one.
    pub fn around(points: impl IntoIterator<Item = DVec3> + Clone) -> Self {
        let center = Aabb::around(points.clone()).center();
        let radius_sq = points
            .into_iter()
            .fold(0.0f64, |r, p| r.max(p.distance_squared(center)));
        // Difference, two products, two sums and the root round.
        Self {
            center,
            radius: radius_sq.sqrt() * (1.0 + gamma(5)),
        }
    }

    /// True if the point lies inside or on the sphere.
    pub fn contains(&self, point: DVec3) -> bool {
        point.distance(self.center) <= self.radius
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn empty_box_is_neutral_and_contains_nothing() {
        let b = Aabb::around([DVec3::ONE, DVec3::ZERO]);
        assert!(Aabb::EMPTY.is_empty());
        assert!(!b.is_empty());
        assert_eq!(Aabb::EMPTY.union(b), b);
        assert!(!Aabb::EMPTY.contains(DVec3::ZERO));
        assert!(b.contains(DVec3::splat(0.5)) && b.contains(DVec3::ONE));
        assert!(!b.contains(DVec3::new(0.5, 0.5, 1.0f64.next_up())));
    }

    #[test]
    fn corners_are_the_eight_extremes() {
        let b = Aabb::around([DVec3::new(-1.0, 2.0, 3.0), DVec3::new(4.0, 5.0, 6.0)]);
        let corners = b.corners();
        assert_eq!(Aabb::around(corners), b);
        assert!(corners.contains(&b.min) && corners.contains(&b.max));
        assert_eq!(b.center() + b.half_diagonal(), b.max);
    }

    proptest! {
        #[test]
        fn sphere_contains_its_points(xs in prop::collection::vec(prop::array::uniform3(-1e3..1e3f64), 1..12)) {
            let points: Vec<DVec3> = xs.into_iter().map(DVec3::from_array).collect();
            let sphere = BoundingSphere::around(points.iter().copied());
            for p in points {
                prop_assert!(sphere.contains(p), "{p} outside {sphere:?}");
            }
        }
    }
}
