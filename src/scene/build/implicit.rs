//! Implicit surfaces, and formulas wherever they are written.

use std::sync::Arc;

use glam::DVec3;

use super::Builder;
use crate::{
    formula::{Formula, NAMES},
    geometry::{
        Aabb,
        shape::{Implicit, ImplicitError, RootFinder, implicit::MAX_STEPS},
    },
    scene::{
        MIN_LENGTH,
        decode::{short, suggest},
        description::{ImplicitShape, MethodDescription, Number},
        outline::NodeId,
    },
};

impl Builder<'_> {
    /// The formula that a text field holds; a mistake is marked inside the
    /// text.
    pub(super) fn formula(&mut self, place: NodeId, text: &str) -> Option<Formula> {
        let error = match Formula::parse(text) {
            Ok(formula) if formula.is_constant() => {
                let label = "expected `x`, `y` or `z` somewhere";
                let help = "write one such as \"x^2 + y^2 + z^2 - 1\"";
                let message = "this formula is the same everywhere";
                return self.report.reject(place, message, label, help);
            }
            Ok(formula) => return Some(formula),
            Err(error) => error,
        };
        let mut diagnostic = self
            .report
            .about_text(place, error.span, error.message)
            .with_label(error.label);
        if !error.help.is_empty() {
            diagnostic = diagnostic.with_help(error.help);
        }
        if let Some(name) = error.unknown {
            diagnostic = diagnostic.with_help(format!("known are {}", NAMES.join(", ")));
            diagnostic = suggest(diagnostic, &short(&name), NAMES);
        }
        self.report.push(diagnostic);
        None
    }

    /// The shape of `Implicit(..)`; those with the same text, bounds and method
    /// are one in memory.
    pub(super) fn implicit(&mut self, node: NodeId, s: &ImplicitShape) -> Option<Arc<Implicit>> {
        let f = self.report.field(node, "f");
        let formula = self.formula(f, &s.f);
        let bounds = self.corners(node, s);
        let finder = self.finder(node, s.method, bounds);
        let (formula, bounds, finder) = (formula?, bounds?, finder?);
        let key = format!("{bounds:?} {finder:?} {}", s.f);
        if let Some(shape) = self.implicits.get(&key) {
            return Some(shape.clone());
        }
        match Implicit::new(formula, bounds, finder) {
            Ok(shape) => {
                let shape = Arc::new(shape);
                self.implicits.insert(key, shape.clone());
                Some(shape)
            }
            Err(e @ ImplicitError::NoSurface) => {
                let help = "move or widen `bounds`, or shift the formula by a number";
                self.report.reject(f, e.to_string(), "no surface", help)
            }
            Err(e @ ImplicitError::UnboundedGradient) => {
                let place = self.report.field(node, "method");
                let label = "needs a bounded gradient all over `bounds`";
                let help = "use `method: Interval`, or a formula without poles and roots there";
                self.report.reject(place, e.to_string(), label, help)
            }
        }
    }

    /// A box with a volume from two corners.
    fn corners(&mut self, node: NodeId, s: &ImplicitShape) -> Option<Aabb> {
        let place = self.report.field(node, "bounds");
        let at = |i| self.report.outline.item(place, i).unwrap_or(place);
        let (low, high) = (at(0), at(1));
        let min = self.report.point_here(low, s.bounds[0]);
        let max = self.report.point_here(high, s.bounds[1]);
        let (min, max) = (min?, max?);
        let size = max - min;
        let Some(axis) = (0..3).find(|&i| size[i] < MIN_LENGTH) else {
            return Some(Aabb { min, max });
        };
        let label = format!("not above {} in {}", min[axis], ["x", "y", "z"][axis]);
        let help = "write the lowest corner first: ((x, y, z), (x, y, z))";
        self.report
            .reject(high, "bounds without a volume", label, help)
    }

    fn finder(
        &mut self,
        node: NodeId,
        method: MethodDescription,
        bounds: Option<Aabb>,
    ) -> Option<RootFinder> {
        match method {
            MethodDescription::Interval => Some(RootFinder::Interval),
            MethodDescription::SphereTracing => Some(RootFinder::SphereTracing),
            MethodDescription::March { step } => self.march(node, step, bounds?),
        }
    }

    fn march(&mut self, node: NodeId, step: Number, bounds: Aabb) -> Option<RootFinder> {
        let method = self.report.field(node, "method");
        let step = self.report.length(method, "step", step)?;
        let least = DVec3::distance(bounds.min, bounds.max) / MAX_STEPS;
        if step >= least {
            return Some(RootFinder::March { step });
        }
        let place = self.report.field(method, "step");
        let label = format!("expected at least {least:.3e} metres");
        let help = format!("at most {MAX_STEPS} steps lead from corner to corner of `bounds`");
        self.report.reject(place, "steps too short", label, help)
    }
}

#[cfg(test)]
mod tests {
    use std::{path::Path, sync::Arc};

    use crate::{geometry::Shape, scene::load_str};

    /// Equal formulas are kept once, whatever their place; others are not.
    #[test]
    fn equal_formulas_are_shared() {
        let ball = |more: &str| {
            format!(
                "(shape: Implicit(f: \"x^2 + y^2 + z^2 - 1\", {more}), material: Mirror(),
                  at: (translate: (1, 2, 3))),"
            )
        };
        let usual = "bounds: ((-2, -2, -2), (2, 2, 2))";
        let objects = [
            ball(usual),
            ball(usual),
            ball("bounds: ((-2, -2, -2), (2, 2, 3))"),
            ball(&format!("{usual}, method: SphereTracing")),
        ];
        let text = format!(
            "(camera: (eye: (0, -9, 3), look_at: (0, 0, 0), fov: 30),
              image: (width: 8, height: 8), objects: [{}],
              lights: [Point(position: (0, 0, 8), power: 100)])",
            objects.concat()
        );
        let scene = load_str(&text, "test.ron", Path::new("")).expect("a sound scene");
        let shapes: Vec<_> = scene.world.instances().iter().map(|i| &i.shape).collect();
        let same = |a: usize, b: usize| match (shapes[a], shapes[b]) {
            (Shape::Implicit(a), Shape::Implicit(b)) => Arc::ptr_eq(a, b),
            _ => unreachable!("formulas only"),
        };
        assert!(same(0, 1));
        assert!(!same(0, 2) && !same(0, 3) && !same(2, 3));
    }
}
