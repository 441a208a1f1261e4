//! The plot of error against time: a dot for each run, a line through the
//! means, the name at the line's end.

use libm::sqrt;

use super::{
    drawing::{Anchor, Drawing},
    frame::Frame,
    palette::{Ink, Medium},
    scale::drawable,
    words::{columns, counted, digits, duration, error_of, level, per_cent, shortened, slope},
};
use crate::study::{Fit, Point, Series};

/// Columns of the longest name beside a line.
const NAME: usize = 26;
/// Width of a column in a plot's letters, about.
const COLUMN: f64 = 7.6;
/// Height of a line of letters in a plot.
const LINE: f64 = 14.0;

/// How much room a plot has.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Room {
    /// A desk's screen or paper: names stand beside the lines.
    Wide,
    /// A telephone: names are in the legend only.
    Narrow,
}

/// One curve.
pub(super) struct Curve<'a> {
    /// What was measured.
    pub(super) series: &'a Series,
    /// Its name in this plot.
    pub(super) name: String,
    /// Its look.
    pub(super) number: usize,
    /// Its place among the scene's series.
    pub(super) place: usize,
}

/// Curves of error against time that belong together.
pub(super) struct Plot<'a> {
    /// What they show.
    pub(super) title: String,
    /// The curves.
    pub(super) curves: Vec<Curve<'a>>,
    /// Errors that were asked for.
    pub(super) targets: Vec<f64>,
    /// Error of the truth itself.
    pub(super) truth: Option<f64>,
}

/// Mean time and error of the runs of a point; its error is the root of the
/// mean square.
pub(super) fn mean(point: &Point) -> Option<[f64; 2]> {
    let count = point.runs.len() as f64;
    let seconds = point.runs.iter().map(|r| r.cpu_seconds / count).sum();
    let square: f64 = point.runs.iter().map(|r| r.relmse / count).sum();
    let error = sqrt(square);
    (drawable(seconds) && drawable(error)).then_some([seconds, error])
}

/// What a dot says.
fn run_words(name: &str, point: &Point, index: usize) -> String {
    let run = &point.runs[index];
    let error = error_of(run).map_or("no number".to_owned(), |e| per_cent(e, 3));
    format!(
        "{name} · {} · seed {} · {}\u{a0}CPU\u{a0}s · error {error}",
        counted(point.passes as usize, "pass", "passes"),
        run.seed,
        digits(run.cpu_seconds, 3)
    )
}

/// A fitted slope with its confidence interval, in words.
pub(super) fn fit_words(fit: Option<&Fit>) -> String {
    let Some(fit) = fit else {
        return "no slope: fewer than three points".to_owned();
    };
    let [low, high] = fit.slope_interval.map(slope);
    format!("slope {} (90\u{a0}%: {low} to {high})", slope(fit.slope))
}

impl Plot<'_> {
    /// Runs that have no place on logarithmic axes.
    pub(super) fn left_out(&self) -> usize {
        let runs = self.curves.iter().flat_map(|c| &c.series.points);
        runs.flat_map(|p| &p.runs)
            .filter(|r| !drawable(r.cpu_seconds) || !error_of(r).is_some_and(drawable))
            .count()
    }

    /// Runs that have one.
    pub(super) fn drawn(&self) -> usize {
        let points = self.curves.iter().flat_map(|c| &c.series.points);
        points.map(|p| p.runs.len()).sum::<usize>() - self.left_out()
    }

    /// The plot as SVG.
    pub(super) fn draw(&self, medium: Medium, room: Room) -> String {
        let lines = if medium == Medium::Paper { 2.0 } else { 1.0 };
        let names = self.curves.iter().map(|c| columns(&c.name).min(NAME));
        // What paper says of a slope takes as many columns as a long name.
        let widest = match medium {
            Medium::Paper => NAME + 4,
            Medium::Page => names.max().unwrap_or(0),
        };
        let (size, across, down) = match room {
            Room::Wide => {
                let labels = self.curves.len() as f64 * lines * LINE;
                let height = (labels + 64.0).max(440.0);
                let right = 760.0 - 24.0 - widest as f64 * COLUMN;
                ([760.0, height], [74.0, right], [12.0, height - 48.0])
            }
            Room::Narrow => ([340.0, 340.0], [66.0, 334.0], [10.0, 292.0]),
        };
        let frame = self.frame(across, down);
        let mut drawing = Drawing::new(medium, size);
        frame.draw(&mut drawing);
        self.draw_levels(&mut drawing, &frame);
        for curve in &self.curves {
            drawing.group("series", curve.place, |drawing| {
                draw_curve(drawing, &frame, curve);
            });
        }
        if room == Room::Wide {
            self.draw_names(&mut drawing, &frame, lines);
        }
        let class = match room {
            Room::Wide => "plot wide",
            Room::Narrow => "plot narrow",
        };
        drawing.finish(class, &self.title, &self.describe())
    }

    fn frame(&self, across: [f64; 2], down: [f64; 2]) -> Frame {
        let runs = || {
            let points = self.curves.iter().flat_map(|c| &c.series.points);
            points.flat_map(|p| &p.runs)
        };
        let both = || {
            let places = runs().filter_map(|r| Some([r.cpu_seconds, error_of(r)?]));
            places.filter(|[seconds, error]| drawable(*seconds) && drawable(*error))
        };
        let errors: Vec<f64> = both().map(|place| place[1]).collect();
        let [low, high] = errors.iter().fold([f64::INFINITY, 0.0], |[low, high], e| {
            [e.min(low), e.max(high)]
        });
        // Levels near the curves are shown, too; those far off would squeeze them.
        let near = |level: &f64| (low / 2.0..=high * 2.0).contains(level);
        let levels = self.targets.iter().copied().chain(self.truth).filter(near);
        let errors = errors.iter().copied().chain(levels);
        Frame::new(both().map(|place| place[0]), errors, across, down)
    }

    /// The errors that were asked for, and that of the truth.
    fn draw_levels(&self, drawing: &mut Drawing, frame: &Frame) {
        let [left, right] = frame.across;
        for &target in self.targets.iter().filter(|t| frame.y.holds(**t)) {
            let y = frame.y.place(target);
            drawing.line([[left, y], [right, y]], Ink::Rule, "2 4");
            let words = format!("target {}", level(target));
            drawing.text([left + 6.0, y - 4.0], Anchor::Start, Ink::Quiet, &words);
        }
        if let Some(error) = self.truth.filter(|t| frame.y.holds(*t)) {
            let y = frame.y.place(error);
            drawing.line([[left, y], [right, y]], Ink::Text, "1 3");
            let words = format!("the truth’s own error {}", per_cent(error, 2));
            drawing.text([left + 6.0, y - 4.0], Anchor::Start, Ink::Text, &words);
        }
    }

    /// Names beside the ends of lines, moved apart where they would overlap.
    fn draw_names(&self, drawing: &mut Drawing, frame: &Frame, lines: f64) {
        let mut names: Vec<(&Curve, [f64; 2])> = Vec::new();
        for curve in &self.curves {
            let mut means = curve.series.points.iter().filter_map(mean);
            let end = means.next_back().and_then(|[s, e]| frame.place(s, e));
            names.extend(end.map(|end| (curve, end)));
        }
        names.sort_by(|a, b| a.1[1].total_cmp(&b.1[1]));
        let wanted: Vec<f64> = names.iter().map(|(_, end)| end[1]).collect();
        let step = LINE * lines;
        let [top, bottom] = frame.down;
        let right = frame.across[1];
        let places = apart(&wanted, step, [top + 6.0, bottom - step + 8.0]);
        for ((curve, end), y) in names.into_iter().zip(places) {
            drawing.group("name", curve.place, |drawing| {
                let elbow = [right + 8.0, y];
                if end[0] + 6.0 < elbow[0] {
                    drawing.line([[end[0] + 6.0, end[1]], elbow], Ink::Grid, "");
                }
                drawing.dot([right + 14.0, y], curve.number, None, false);
                let name = shortened(&curve.name, NAME);
                drawing.text([right + 22.0, y + 4.0], Anchor::Start, Ink::Text, &name);
                if drawing.medium() == Medium::Paper {
                    let words = paper_fit(curve.series.fit.as_ref());
                    let at = [right + 22.0, y + 4.0 + LINE];
                    drawing.text(at, Anchor::Start, Ink::Quiet, &words);
                }
            });
        }
    }

    /// The plot in words, for those who do not see it.
    fn describe(&self) -> String {
        let mut words = vec![counted(self.drawn(), "run is drawn", "runs are drawn")];
        for curve in &self.curves {
            let mut means = curve.series.points.iter().filter_map(mean);
            let Some(first) = means.next() else {
                continue;
            };
            let last = means.next_back().unwrap_or(first);
            let say = |[s, e]: [f64; 2]| format!("{} after {}", per_cent(e, 2), duration(s));
            words.push(format!("{}: {}, {}", curve.name, say(first), say(last)));
        }
        words.join("; ")
    }
}

/// A slope in few words.
fn paper_fit(fit: Option<&Fit>) -> String {
    fit.map_or(String::new(), |fit| {
        let [low, high] = fit.slope_interval.map(slope);
        format!("slope {} ({low} to {high})", slope(fit.slope))
    })
}

fn draw_curve(drawing: &mut Drawing, frame: &Frame, curve: &Curve) {
    let means = curve.series.points.iter().filter_map(mean);
    let line: Vec<[f64; 2]> = means.filter_map(|[s, e]| frame.place(s, e)).collect();
    drawing.curve(&line, curve.number, "");
    for point in &curve.series.points {
        for (index, run) in point.runs.iter().enumerate() {
            let place = error_of(run).and_then(|e| frame.place(run.cpu_seconds, e));
            if let Some(at) = place {
                let words = run_words(&curve.name, point, index);
                drawing.dot(at, curve.number, Some(&words), false);
            }
        }
    }
}

/// Places as near as may be to those wanted (which grow), at least `step` apart
/// and within the ends as far as they all fit.
fn apart(wanted: &[f64], step: f64, [low, high]: [f64; 2]) -> Vec<f64> {
    let mut places: Vec<f64> = Vec::with_capacity(wanted.len());
    for &want in wanted {
        let least = places.last().map_or(low, |last| last + step);
        places.push(want.max(least));
    }
    let mut most = high;
    for place in places.iter_mut().rev() {
        *place = place.min(most);
        most = *place - step;
    }
    places
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_keep_apart() {
        assert_eq!(apart(&[10.0, 50.0], 14.0, [0.0, 100.0]), [10.0, 50.0]);
        assert_eq!(
            apart(&[10.0, 12.0, 13.0], 14.0, [0.0, 100.0]),
            [10.0, 24.0, 38.0]
        );
        assert_eq!(apart(&[98.0, 99.0], 14.0, [0.0, 100.0]), [86.0, 100.0]);
        assert_eq!(apart(&[-5.0], 14.0, [0.0, 100.0]), [0.0]);
        assert!(apart(&[], 14.0, [0.0, 100.0]).is_empty());
    }
}
