//! Checks that recur: lengths, points, directions, colours, alternatives.

use glam::DVec3;

use crate::{
    scene::{
        MAX_LENGTH, MIN_LENGTH,
        description::{Colour, Number, Triple},
        outline::NodeId,
        report::Report,
    },
    spectrum::{Rgb, srgb_linear},
};

/// Largest value of a light's colour, in its own unit.
const MAX_LIGHT: f64 = 1e30;

impl Report {
    /// Reports a field's value; always `None`, so that checks can end in it.
    pub(super) fn reject<T>(
        &mut self,
        place: NodeId,
        message: impl Into<String>,
        label: impl Into<String>,
        help: impl Into<String>,
    ) -> Option<T> {
        let help = help.into();
        let mut diagnostic = self.about(place, message).with_label(label);
        if !help.is_empty() {
            diagnostic = diagnostic.with_help(help);
        }
        self.push(diagnostic);
        None
    }

    /// A length above zero.
    pub(super) fn length(&mut self, node: NodeId, key: &str, value: Number) -> Option<f64> {
        let place = self.field(node, key);
        let v = value.0;
        if (MIN_LENGTH..=MAX_LENGTH).contains(&v) {
            return Some(v);
        }
        let label = format!("expected a length from {MIN_LENGTH:e} to {MAX_LENGTH:e} metres");
        if v < 0.0 {
            let help = format!("lengths are positive: write {}", -v);
            return self.reject(place, format!("negative {key}"), label, help);
        }
        if v == 0.0 {
            return self.reject(
                place,
                format!("the {key} is zero"),
                label,
                "lengths are above 0",
            );
        }
        let size = if v < MIN_LENGTH { "small" } else { "large" };
        self.reject(
            place,
            format!("the {key} is too {size}"),
            label,
            "lengths are in metres",
        )
    }

    /// A point within the range of the language.
    pub(super) fn point(&mut self, node: NodeId, key: &str, value: Triple) -> Option<DVec3> {
        let place = self.field(node, key);
        self.point_here(place, value)
    }

    /// A point whose own place is known.
    pub(super) fn point_here(&mut self, place: NodeId, value: Triple) -> Option<DVec3> {
        let p = DVec3::from(value);
        if p.abs().max_element() <= MAX_LENGTH {
            return Some(p);
        }
        let label = format!("expected coordinates up to {MAX_LENGTH:e} metres");
        self.reject(
            place,
            "this point is too far away",
            label,
            "lengths are in metres",
        )
    }

    /// A unit vector in the direction that is written.
    pub(super) fn direction(&mut self, node: NodeId, key: &str, value: Triple) -> Option<DVec3> {
        let place = self.field(node, key);
        match unit(value.into()) {
            Some(v) => Some(v),
            None => self.reject(
                place,
                format!("the {key} is the zero vector"),
                "expected a direction",
                "a direction has at least one coordinate that isn't 0, such as (0, 0, 1)",
            ),
        }
    }

    /// A reflectance: all channels in `[0, 1]`.
    pub(super) fn reflectance(&mut self, node: NodeId, value: Colour) -> Option<Rgb> {
        let c = linear(value);
        if c.0.iter().all(|v| (0.0..=1.0).contains(v)) {
            return Some(c);
        }
        let place = self.field(node, "reflectance");
        let message = if c.0.iter().any(|&v| v < 0.0) {
            "negative reflectance"
        } else {
            "a surface that reflects more light than it receives"
        };
        self.reject(
            place,
            message,
            "expected channels in [0, 1]",
            "a reflectance is the fraction of the light that is reflected",
        )
    }

    /// The colour of a light: no channel negative, one at least positive.
    pub(super) fn light_colour(&mut self, node: NodeId, key: &str, value: Colour) -> Option<Rgb> {
        let c = linear(value);
        let place = self.field(node, key);
        let label = "expected channels from 0 up, not all 0";
        if c.0.iter().any(|&v| v < 0.0) {
            return self.reject(
                place,
                format!("negative {key}"),
                label,
                "light cannot be taken away",
            );
        }
        if c.is_black() {
            let help = "remove the light, or comment it out";
            return self.reject(place, "a light without light", label, help);
        }
        if c.max() > MAX_LIGHT {
            let help = format!("the largest value is {MAX_LIGHT:e}");
            return self.reject(place, format!("the {key} is too large"), label, help);
        }
        Some(c)
    }

    /// Exactly one of several fields must be there: its index.
    pub(super) fn exactly_one(&mut self, node: NodeId, fields: &[(&str, bool)]) -> Option<usize> {
        let given: Vec<usize> = (0..fields.len()).filter(|&i| fields[i].1).collect();
        let names: Vec<String> = fields.iter().map(|f| format!("`{}`", f.0)).collect();
        let names = names.join(" or ");
        match given.as_slice() {
            [one] => Some(*one),
            [] => {
                let diagnostic = self
                    .about_head(node, format!("missing {names}"))
                    .with_label(format!("needs {names}"))
                    .with_help(format!("add exactly one of {names}"));
                self.push(diagnostic);
                None
            }
            [..] => {
                // The mark is on the one written last.
                let places = given
                    .iter()
                    .map(|&i| (self.field(node, fields[i].0), fields[i].0));
                let mut places: Vec<_> = places.collect();
                places.sort_by_key(|&(place, _)| self.outline.span(place).start);
                let [.., (_, a), (place, b)] = places[..] else {
                    return None;
                };
                let diagnostic = self
                    .about_key(place, format!("`{a}` and `{b}` exclude each other"))
                    .with_label(format!("`{a}` is given, too"))
                    .with_help(format!("keep exactly one of {names}"));
                self.push(diagnostic);
                None
            }
        }
    }
}

/// A vector's direction, without overflow on the way.
pub(super) fn unit(v: DVec3) -> Option<DVec3> {
    let largest = v.abs().max_element();
    (largest > 0.0 && largest.is_finite()).then(|| (v / largest).normalize())
}

/// The linear sRGB coefficients of a colour.
pub(super) fn linear(colour: Colour) -> Rgb {
    match colour {
        Colour::Grey(v) => Rgb::grey(v),
        Colour::Linear([r, g, b]) => Rgb::new(r, g, b),
        Colour::Hex(bytes) => Rgb(bytes.map(|b| srgb_linear(f64::from(b) / 255.0))),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn hex_colours_are_decoded() {
        assert_eq!(linear(Colour::Hex([0, 255, 0])), Rgb::new(0.0, 1.0, 0.0));
        // sRGB 0xbc is the grey that reflects half the light, nearly.
        assert!((linear(Colour::Hex([0xbc; 3])).max() - 0.502_886).abs() < 1e-6);
        assert!((linear(Colour::Hex([10; 3])).max() - 0.003_035_27).abs() < 1e-8);
    }

    #[test]
    fn directions_of_any_length_become_unit() {
        for scale in [1e-300, 1.0, 1e300] {
            let v = unit(DVec3::new(3.0 * scale, 0.0, -4.0 * scale)).unwrap();
            assert!(
                (v - DVec3::new(0.6, 0.0, -0.8)).length() < 1e-15,
                "{scale:e}"
            );
        }
        assert_eq!(unit(DVec3::ZERO), None);
    }
}
