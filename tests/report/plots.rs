//! The plots, read back: dots are where their runs belong. Places are undone
//! with the labels of the axes, as a reader would do it, not with the code that
//! drew them.

use std::fs;

use nephroid::study::{Run, Study, report};

use crate::fixture::{alone, put_pictures, study};

/// Attributes `x` and `y` of a translation.
fn translation(element: &str) -> [f64; 2] {
    let inside = element
        .split("translate(")
        .nth(1)
        .unwrap()
        .split(')')
        .next()
        .unwrap();
    let mut parts = inside.split(' ').map(|p| p.parse().unwrap());
    [parts.next().unwrap(), parts.next().unwrap()]
}

fn attribute<'a>(element: &'a str, name: &str) -> &'a str {
    let start = element.find(&format!(" {name}=\"")).unwrap() + name.len() + 3;
    element[start..].split('"').next().unwrap()
}

/// A label of an axis as a number: "0.3", "10⁻⁷".
fn number(label: &str) -> f64 {
    if let Ok(plain) = label.parse() {
        return plain;
    }
    let (mantissa, raised) = match label.split_once('·') {
        Some((mantissa, power)) => (mantissa.parse().unwrap(), power),
        None => (1.0, label),
    };
    let digits: String = raised
        .strip_prefix("10")
        .unwrap()
        .chars()
        .map(|c| match c {
            '⁻' => '-',
            _ => char::from(b'0' + "⁰¹²³⁴⁵⁶⁷⁸⁹".chars().position(|d| d == c).unwrap() as u8),
        })
        .collect();
    mantissa * libm::pow(10.0, digits.parse().unwrap())
}

/// From a place to the logarithm of its number, by two labels of an axis.
struct Axis([(f64, f64); 2]);

impl Axis {
    fn new(mut labels: Vec<(f64, f64)>) -> Self {
        labels.sort_by(|a, b| a.1.total_cmp(&b.1));
        let line = Self([labels[0], labels[labels.len() - 1]]);
        assert!(line.0[0].1 < line.0[1].1, "an axis needs two labels");
        // Places have two decimals.
        let step = 0.01 * (line.log(1.0) - line.log(0.0)).abs();
        for (place, value) in labels {
            let off = (line.log(place) - libm::log10(value)).abs();
            assert!(off < 2.0 * step, "{value} is off by {off}");
        }
        line
    }

    fn log(&self, place: f64) -> f64 {
        let [(p, v), (q, w)] = self.0;
        let [v, w] = [v, w].map(libm::log10);
        v + (place - p) / (q - p) * (w - v)
    }
}

/// Logarithms of seconds and of errors of all dots of an SVG.
fn dots(svg: &str) -> Vec<[f64; 2]> {
    let (mut across, mut up) = (Vec::new(), Vec::new());
    for text in svg.split("<text ").skip(1).filter(|t| t.starts_with("x=")) {
        let text = format!(" {}", text.split("</text>").next().unwrap());
        let words = text.split('>').nth(1).unwrap();
        let place = |name: &str| attribute(&text, name).parse::<f64>().unwrap();
        let anchor = text.split("text-anchor=\"").nth(1).map(|a| &a[..3]);
        match anchor {
            Some("end") => {
                let value = number(words.strip_suffix("\u{a0}%").unwrap());
                // The base line of a label is four units below its tick.
                up.push((place("y") - 4.0, value / 100.0));
            }
            Some("mid") if !words.contains("time") => across.push((place("x"), number(words))),
            _ => {}
        }
    }
    let (across, up) = (Axis::new(across), Axis::new(up));
    let dots = svg.split("<path class=\"dot\"").skip(1).map(translation);
    dots.map(|[x, y]| [across.log(x), up.log(y)]).collect()
}

fn runs(study: &Study, sweep: bool) -> Vec<&Run> {
    let series = study.scenes.iter().flat_map(|s| &s.series);
    let kept = series.filter(|s| sweep || s.sweep.is_none());
    kept.flat_map(|s| &s.points).flat_map(|p| &p.runs).collect()
}

fn expected(runs: &[&Run]) -> Vec<[f64; 2]> {
    let logs = runs
        .iter()
        .map(|r| [libm::log10(r.cpu_seconds), libm::log10(r.relmse) / 2.0]);
    logs.filter(|l| l[0].is_finite() && l[1].is_finite())
        .collect()
}

/// As many, in the same order (a picture's dots are drawn series by series).
fn compare(found: &[[f64; 2]], wanted: &[[f64; 2]]) {
    assert_eq!(found.len(), wanted.len());
    let all = || wanted.iter().flatten();
    let size = all().fold(0.0, |a: f64, b| a.max(*b)) - all().fold(0.0, |a: f64, b| a.min(*b));
    for (found, wanted) in found.iter().zip(wanted) {
        for k in 0..2 {
            assert!(
                (found[k] - wanted[k]).abs() < 1e-4 * (1.0 + size),
                "{found:?}, not {wanted:?}"
            );
        }
    }
}

/// The plots of the page's first figure and the file for paper.
fn first_plots(study: &Study) -> Vec<String> {
    let directory = tempfile::tempdir().unwrap();
    put_pictures(study, directory.path());
    report::write(study, directory.path()).unwrap();
    let page = fs::read_to_string(directory.path().join("index.html")).unwrap();
    let mut plots: Vec<String> = page
        .split("<svg class=\"plot ")
        .skip(1)
        .take(2)
        .map(|p| p.split("</svg>").next().unwrap().to_owned())
        .collect();
    let mut files: Vec<_> = fs::read_dir(directory.path().join("plots"))
        .unwrap()
        .collect();
    files.sort_by_key(|f| f.as_ref().unwrap().path());
    let error = files.into_iter().map(|f| f.unwrap().path());
    let error = error.filter(|p| p.to_str().unwrap().ends_with("-error.svg"));
    plots.extend(error.map(|p| fs::read_to_string(p).unwrap()));
    plots
}

#[test]
fn every_run_is_a_dot_at_its_place() {
    let whole = study();
    for scene in whole.scenes {
        let one = alone(scene);
        let plots = first_plots(&one);
        assert_eq!(plots.len(), 3, "wide, narrow, paper");
        for plot in &plots {
            compare(&dots(plot), &expected(&runs(&one, false)));
        }
    }
}

/// Dots from 1e-250 to 1e250, and what cannot be drawn is left out and counted.
#[test]
fn extremes_are_drawn_or_counted() {
    let mut one = alone(study().scenes.swap_remove(0));
    one.scenes[0].series.truncate(1);
    let points = &mut one.scenes[0].series[0].points;
    points[0].runs[0].cpu_seconds = 1e-250;
    points[0].runs[1].cpu_seconds = 1e250;
    points[1].runs[0].relmse = 1e-250;
    points[1].runs[1].relmse = 1e250;
    for (run, value) in [(0, f64::NAN), (1, f64::INFINITY), (2, 0.0), (3, -1.0)] {
        points[2].runs[run].relmse = value;
        points[3].runs[run].cpu_seconds = value;
    }
    let mut kept = alone(one.scenes[0].clone());
    kept.scenes[0].series[0].points.drain(2..4);
    for plot in first_plots(&one) {
        compare(&dots(&plot), &expected(&runs(&kept, false)));
    }
    let directory = tempfile::tempdir().unwrap();
    report::write(&one, directory.path()).unwrap();
    let page = fs::read_to_string(directory.path().join("index.html")).unwrap();
    assert!(page.contains("8 runs are not drawn"));
}

#[test]
fn thirty_series_and_single_points() {
    let mut one = alone(study().scenes.swap_remove(0));
    let model = one.scenes[0].series[0].clone();
    one.scenes[0].series = (0..30)
        .map(|k| {
            let mut series = model.clone();
            series.label = format!("series {k}");
            for run in series.points.iter_mut().flat_map(|p| &mut p.runs) {
                run.relmse *= f64::from(k + 1);
            }
            series
        })
        .collect();
    for plot in first_plots(&one) {
        compare(&dots(&plot), &expected(&runs(&one, false)));
    }
    one.scenes[0].series.truncate(1);
    one.scenes[0].series[0].points.truncate(1);
    one.scenes[0].series[0].points[0].runs.truncate(1);
    for plot in first_plots(&one) {
        compare(&dots(&plot), &expected(&runs(&one, false)));
        assert!(!plot.contains("class=\"mean\""), "one point is no line");
    }
}
