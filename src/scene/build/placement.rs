//! Where an object stands: the `at` field.

use glam::{DAffine3, DMat3, DVec3};

use super::Builder;
use crate::{
    geometry::Transform,
    numeric::trig,
    scene::{
        MAX_LENGTH, MIN_LENGTH,
        description::{Part, Rotation, Rotations, TransformStep},
        outline::NodeId,
    },
};

/// A mistake that has been reported.
pub(super) struct Reported;

impl Builder<'_> {
    /// The map from the shape's own space to the world; `None` where they are
    /// the same.
    pub(super) fn placement(
        &mut self,
        at: Option<&Part<Vec<Part<TransformStep>>>>,
    ) -> Result<Option<Transform>, Reported> {
        let Some(Part { node, value: steps }) = at else {
            return Ok(None);
        };
        let steps: Vec<_> = steps.iter().map(|s| (s.node, &s.value)).collect();
        let map = self.steps(*node, &steps).ok_or(Reported)?;
        self.regular(*node, map)
    }

    /// Steps, each with its place, as one map.
    pub(super) fn steps(
        &mut self,
        node: NodeId,
        steps: &[(NodeId, &TransformStep)],
    ) -> Option<DAffine3> {
        let mut map = DAffine3::IDENTITY;
        for (node, step) in steps {
            map = self.step(*node, step)? * map;
        }
        self.regular(node, map).ok().map(|_| map)
    }

    /// A map that can be inverted and stays within the range of lengths;
    /// `None` if it moves nothing.
    pub(super) fn regular(
        &mut self,
        node: NodeId,
        map: DAffine3,
    ) -> Result<Option<Transform>, Reported> {
        if map == DAffine3::IDENTITY {
            return Ok(None);
        }
        let columns = [map.matrix3.x_axis, map.matrix3.y_axis, map.matrix3.z_axis];
        let range = MIN_LENGTH..=MAX_LENGTH;
        let within = columns
            .iter()
            .all(|c| range.contains(&c.abs().max_element()))
            && map.translation.abs().max_element() <= MAX_LENGTH;
        let transform = Transform::new(map).filter(|_| within);
        if transform.is_none() {
            let label = "this map cannot be inverted, or leaves the range of lengths";
            let help = "no axis may be scaled to (nearly) nothing";
            self.report
                .reject::<()>(node, "a singular transform", label, help);
            return Err(Reported);
        }
        Ok(transform)
    }

    /// Scale, then rotate, then translate.
    fn step(&mut self, node: NodeId, step: &TransformStep) -> Option<DAffine3> {
        let mut map = DAffine3::IDENTITY;
        if let Some(scale) = step.scale {
            let s = DVec3::from_array(scale.0);
            if s.abs().min_element() < MIN_LENGTH || s.abs().max_element() > MAX_LENGTH {
                let place = self.report.field(node, "scale");
                let message = if s.abs().min_element() == 0.0 {
                    "a singular transform: an axis is scaled to nothing"
                } else {
                    "a singular transform: a scale out of range"
                };
                let label = format!(
                    "expected factors from {MIN_LENGTH:e} to {MAX_LENGTH:e}, or their negatives"
                );
                return self.report.reject(
                    place,
                    message,
                    label,
                    "a factor of 1 leaves an axis as it is",
                );
            }
            map = DAffine3::from_scale(s);
        }
        if let Some(rotations) = &step.rotate {
            map = DAffine3::from_mat3(self.rotations(node, rotations)?) * map;
        }
        if let Some(translate) = step.translate {
            let shift = self.report.point(node, "translate", translate)?;
            map = DAffine3::from_translation(shift) * map;
        }
        Some(map)
    }

    /// The rotations of the field `rotate`, the first one first.
    pub(super) fn rotations(&mut self, node: NodeId, list: &Rotations) -> Option<DMat3> {
        let place = self.report.field(node, "rotate");
        let mut map = DMat3::IDENTITY;
        for rotation in &list.0 {
            map = self.rotation(place, rotation)? * map;
        }
        Some(map)
    }

    /// Rodrigues' formula, with the angle reduced in degrees, where quarter
    /// turns are exact.
    fn rotation(&mut self, place: NodeId, rotation: &Rotation) -> Option<DMat3> {
        let axis = self.report.direction(place, "axis", rotation.axis)?;
        let (sin, cos) = sin_cos_degrees(rotation.degrees.0);
        let turn = |v: DVec3| v * cos + axis.cross(v) * sin + axis * (axis.dot(v) * (1.0 - cos));
        Some(DMat3::from_cols(
            turn(DVec3::X),
            turn(DVec3::Y),
            turn(DVec3::Z),
        ))
    }
}

/// Sine and cosine of an angle in degrees; multiples of 90 are exact.
pub(super) fn sin_cos_degrees(degrees: f64) -> (f64, f64) {
    let reduced = degrees % 360.0;
    let quarters = (reduced / 90.0).round();
    // Exact by Sterbenz's lemma: unless `quarters` is 0, the two are within
    // a factor of two of each other.
    let rest = reduced - 90.0 * quarters;
    let (sin, cos) = trig::sin_cos(rest.to_radians());
    match (quarters as i64).rem_euclid(4) {
        0 => (sin, cos),
        1 => (cos, -sin),
        2 => (-sin, -cos),
        _ => (-cos, sin),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quarter_turns_are_exact_and_others_right() {
        assert_eq!(sin_cos_degrees(90.0), (1.0, 0.0));
        assert_eq!(sin_cos_degrees(-90.0), (-1.0, 0.0));
        assert_eq!(sin_cos_degrees(540.0), (0.0, -1.0));
        for d in [30.0f64, 100.0, 200.0, 300.0, -45.0, 1000.0] {
            let (sin, cos) = sin_cos_degrees(d);
            let (s, c) = trig::sin_cos(d.to_radians());
            assert!((sin - s).abs() < 1e-13 && (cos - c).abs() < 1e-13, "{d}");
        }
    }
}
