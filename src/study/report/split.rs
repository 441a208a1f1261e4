//! Noise and bias against time: a small panel for each series, all with the
//! same axes.

use super::{
    curves::{Curve, Room},
    drawing::{Anchor, Drawing},
    frame::Frame,
    palette::{Ink, Medium},
    scale::drawable,
    words::{digits, per_cent, shortened},
};
use crate::study::{Point, Split};

/// A point that was taken apart, and its mean time.
fn parts(curve: &Curve) -> Vec<(f64, Split, u32)> {
    let part = |point: &Point| {
        let count = point.runs.len() as f64;
        let seconds: f64 = point.runs.iter().map(|r| r.cpu_seconds / count).sum();
        drawable(seconds).then_some((seconds, point.split?, point.passes))
    };
    curve.series.points.iter().filter_map(part).collect()
}

/// The panels as SVG; `None` if nothing was taken apart.
pub(super) fn draw(title: &str, curves: &[Curve], medium: Medium, room: Room) -> Option<String> {
    let taken: Vec<_> = curves
        .iter()
        .map(|curve| (curve, parts(curve)))
        .filter(|(_, parts)| !parts.is_empty())
        .collect();
    if taken.is_empty() {
        return None;
    }
    let (width, across) = match room {
        Room::Wide => (760.0, 4),
        Room::Narrow => (340.0, 2),
    };
    let left = 58.0;
    let columns = across.min(taken.len());
    let cell = [(width - left) / across as f64, 168.0];
    let rows = taken.len().div_ceil(columns);
    let height = rows as f64 * cell[1] + 26.0;
    let all = || taken.iter().flat_map(|(_, parts)| parts);
    let errors: Vec<f64> = all().flat_map(|(_, s, _)| [s.noise, s.bias]).collect();
    let mut drawing = Drawing::new(medium, [width, height]);
    for (index, (curve, parts)) in taken.iter().enumerate() {
        let x = left + (index % columns) as f64 * cell[0];
        let y = (index / columns) as f64 * cell[1];
        let frame = Frame::new(
            all().map(|part| part.0),
            errors.iter().copied(),
            [x, x + cell[0] - 14.0],
            [y + 24.0, y + cell[1] - 26.0],
        );
        drawing.group("series", curve.place, |drawing| {
            frame.draw_axes(drawing, index % columns == 0);
            let name = shortened(&curve.name, (cell[0] / 7.0) as usize);
            drawing.text([x + 4.0, y + 14.0], Anchor::Start, Ink::Text, &name);
            draw_parts(drawing, &frame, curve, parts);
        });
    }
    let middle = f64::midpoint(left, width);
    let words = match room {
        Room::Wide => "processor time of all threads in seconds",
        Room::Narrow => "processor time in seconds",
    };
    drawing.text([middle, height - 6.0], Anchor::Middle, Ink::Quiet, words);
    let class = match room {
        Room::Wide => "plot wide",
        Room::Narrow => "plot narrow",
    };
    let description =
        "Filled markers and solid lines: noise. Hollow markers and dashed lines: bias";
    Some(drawing.finish(class, title, description))
}

/// A part of the error: its name, its value, its dashes, and whether its markers
/// are hollow.
type Kind = (&'static str, fn(&Split) -> f64, &'static str, bool);

fn draw_parts(drawing: &mut Drawing, frame: &Frame, curve: &Curve, parts: &[(f64, Split, u32)]) {
    let kinds: [Kind; 2] = [
        ("noise", |s| s.noise, "", false),
        ("bias", |s| s.bias, "4 3", true),
    ];
    for (kind, value, dashed, hollow) in kinds {
        let place = |(s, split, _): &(f64, Split, u32)| frame.place(*s, value(split));
        let line: Vec<[f64; 2]> = parts.iter().filter_map(place).collect();
        drawing.curve(&line, curve.number, dashed);
        for part in parts {
            let (seconds, split, passes) = part;
            let words = format!(
                "{} · {passes} passes · {}\u{a0}CPU\u{a0}s · {kind} {}",
                curve.name,
                digits(*seconds, 3),
                per_cent(value(split), 3)
            );
            // What is zero has no place on the axis and sits on its lower end.
            let floor = (value(split) == 0.0).then(|| [frame.x.place(*seconds), frame.down[1]]);
            if let Some(at) = place(part).or(floor) {
                drawing.dot(at, curve.number, Some(&words), hollow);
            }
        }
    }
}
