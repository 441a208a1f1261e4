//! The frame of a plot of error against time: two logarithmic axes.

use super::{
    drawing::{Anchor, Drawing},
    palette::Ink,
    scale::{LogScale, Tick},
};

/// Length of a labelled tick.
const TICK: f64 = 5.0;

/// Two axes about a rectangle.
pub(super) struct Frame {
    /// Processor time.
    pub(super) x: LogScale,
    /// Error.
    pub(super) y: LogScale,
    /// Left and right edge.
    pub(super) across: [f64; 2],
    /// Upper and lower edge.
    pub(super) down: [f64; 2],
}

impl Frame {
    /// The frame that shows all `times` and `errors` that can be drawn within
    /// the edges.
    pub(super) fn new(
        times: impl Iterator<Item = f64>,
        errors: impl Iterator<Item = f64>,
        across: [f64; 2],
        down: [f64; 2],
    ) -> Self {
        Self {
            x: LogScale::covering(times, across),
            y: LogScale::covering(errors, [down[1], down[0]]),
            across,
            down,
        }
    }

    /// Where a time and an error meet; `None` if one of them has no logarithm.
    pub(super) fn place(&self, seconds: f64, error: f64) -> Option<[f64; 2]> {
        let drawable = super::scale::drawable;
        (drawable(seconds) && drawable(error)).then(|| [self.x.place(seconds), self.y.place(error)])
    }

    /// Draws axes with ticks, labels and names.
    pub(super) fn draw(&self, drawing: &mut Drawing) {
        self.draw_axes(drawing, true);
        let middle = f64::midpoint(self.across[0], self.across[1]);
        let words = "processor time of all threads in seconds";
        let at = [middle, self.down[1] + 39.0];
        drawing.text(at, Anchor::Middle, Ink::Quiet, words);
        let middle = f64::midpoint(self.down[0], self.down[1]);
        drawing.upright([14.0, middle], Ink::Quiet, "error");
    }

    /// Draws axes with ticks and labels; those of errors may be left to a
    /// neighbour with the same axis.
    pub(super) fn draw_axes(&self, drawing: &mut Drawing, errors: bool) {
        let ([left, right], [top, bottom]) = (self.across, self.down);
        // Small frames take what fits, large ones what is enough.
        let (width, height) = (right - left, bottom - top);
        let room = [
            width / if width < 300.0 { 34.0 } else { 62.0 },
            height / if height < 200.0 { 28.0 } else { 40.0 },
        ]
        .map(|labels| (labels as usize).max(2));
        for tick in self.y.ticks(room[1]) {
            let y = self.y.place_of_log(tick.log());
            if tick.labelled {
                drawing.line([[left, y], [right, y]], Ink::Grid, "");
                if errors {
                    let words = format!("{}\u{a0}%", tick.words(2));
                    drawing.text([left - 8.0, y + 4.0], Anchor::End, Ink::Quiet, &words);
                }
            }
            drawing.line([[left - length(tick), y], [left, y]], Ink::Rule, "");
        }
        for tick in self.x.ticks(room[0]) {
            let x = self.x.place_of_log(tick.log());
            if tick.labelled {
                let at = [x, bottom + 20.0];
                drawing.text(at, Anchor::Middle, Ink::Quiet, &tick.words(0));
            }
            drawing.line([[x, bottom], [x, bottom + length(tick)]], Ink::Rule, "");
        }
        drawing.line([[left, bottom], [right, bottom]], Ink::Rule, "");
        drawing.line([[left, top], [left, bottom]], Ink::Rule, "");
    }
}

fn length(tick: Tick) -> f64 {
    if tick.labelled { TICK } else { TICK / 2.0 }
}
