//! Tables: times to errors, the summary over all scenes, legends.

use super::{
    curves::{Curve, fit_words},
    drawing::key,
    words::{duration, escape, factor, level},
};
use crate::study::{SceneStudy, Series, Study, TimeTo};

/// The errors that were asked for anywhere in `series`, from the largest.
pub(super) fn targets<'a>(series: impl Iterator<Item = &'a Series>) -> Vec<f64> {
    let times = series.flat_map(|s| &s.times);
    let mut targets: Vec<f64> = times.map(|t| t.error).filter(|e| e.is_finite()).collect();
    targets.sort_by(|a, b| b.total_cmp(a));
    targets.dedup();
    targets
}

/// What a caption says of the table's types.
const NOTE: &str = " <span>(<b>bold</b>: the best; <em>italics</em>: beyond the last point, by the fitted line)</span>";

/// What is known of the time of a series to an error.
fn time_to(series: &Series, error: f64) -> Option<&TimeTo> {
    series.times.iter().find(|t| t.error == error)
}

fn seconds(series: &Series, error: f64) -> Option<f64> {
    time_to(series, error)?
        .cpu_seconds
        .filter(|s| s.is_finite())
}

/// A cell: the time, what kind of time it is, and its ratio to the best.
fn cell(series: &Series, error: f64, best: Option<f64>) -> String {
    let Some(time) = time_to(series, error) else {
        return "<td class=\"none\">–</td>".to_owned();
    };
    let Some(seconds) = time.cpu_seconds.filter(|s| s.is_finite()) else {
        return "<td class=\"none\">not reached</td>".to_owned();
    };
    let mut words = duration(seconds);
    if time.extrapolated {
        words = format!(
            "<em title=\"beyond the last point\">{words}</em><span class=\"unseen\"> beyond the last point</span>"
        );
    }
    if best == Some(seconds) {
        words = format!("<strong>{words}</strong>");
    }
    let worse = best.filter(|best| *best > 0.0 && *best != seconds);
    let ratio = worse.map_or(String::new(), |best| {
        format!("<small>{}</small>", factor(seconds / best))
    });
    format!("<td>{words}{ratio}</td>")
}

/// Times of `curves` to each error. Only series that judge the same layers are
/// compared with each other.
pub(super) fn times(caption: &str, curves: &[Curve]) -> String {
    let targets = targets(curves.iter().map(|c| c.series));
    if targets.is_empty() {
        return String::new();
    }
    let heads = targets
        .iter()
        .map(|t| format!("<th scope=\"col\">{}</th>", level(*t)));
    let mut out = format!(
        "<div class=\"scroll\" role=\"region\" tabindex=\"0\" aria-label=\"{caption}\"><table class=\"times\">\n\
         <caption>{caption}{NOTE}</caption>\n<thead><tr><th scope=\"col\">method</th>{}</tr></thead>\n<tbody>\n",
        heads.collect::<String>(),
        caption = escape(caption)
    );
    for curve in curves {
        let rivals = || {
            let all = curves.iter().map(|c| c.series);
            all.filter(|s| s.layers == curve.series.layers)
        };
        let cells = targets.iter().map(|target| {
            let best = rivals()
                .filter_map(|s| seconds(s, *target))
                .min_by(f64::total_cmp);
            // Who runs alone does not win.
            let best = best.filter(|_| rivals().count() > 1);
            cell(curve.series, *target, best)
        });
        out += &format!(
            "<tr><th scope=\"row\">{}{}{}</th>{}</tr>\n",
            key(curve.number),
            escape(&curve.name),
            mark(curve.series),
            cells.collect::<String>()
        );
    }
    out + "</tbody></table></div>\n"
}

/// The sign of a series that judges some layers only.
pub(super) fn mark(series: &Series) -> &'static str {
    if series.layers.is_empty() {
        ""
    } else {
        "<span class=\"mark\" title=\"only some layers were judged\">\u{a0}†</span>"
    }
}

/// The error of the summary: of those asked for, the least that some method
/// reaches in half of the scenes or more; the largest if there is none.
pub(super) fn headline(study: &Study) -> Option<f64> {
    let targets = targets(study.scenes.iter().flat_map(|s| &s.series));
    let is_reached = |error: f64| {
        let by_some = |s: &&SceneStudy| s.series.iter().any(|s| seconds(s, error).is_some());
        2 * study.scenes.iter().filter(by_some).count() >= study.scenes.len()
    };
    let least = targets.iter().rev().find(|e| is_reached(**e));
    least.or(targets.first()).copied()
}

/// Methods of all scenes in the order in which they first appear.
pub(super) fn methods(study: &Study) -> Vec<&str> {
    let mut methods: Vec<&str> = Vec::new();
    for series in study.scenes.iter().flat_map(|s| &s.series) {
        if series.sweep.is_none() && !methods.contains(&series.method.as_str()) {
            methods.push(&series.method);
        }
    }
    methods
}

/// Time to the headline's error for each scene and method.
pub(super) fn summary(study: &Study) -> String {
    let (Some(target), methods) = (headline(study), methods(study)) else {
        return "<p>No time to an error is known.</p>\n".to_owned();
    };
    let heads = methods
        .iter()
        .map(|m| format!("<th scope=\"col\">{}</th>", escape(m)));
    let mut out = format!(
        "<div class=\"scroll\" role=\"region\" tabindex=\"0\" aria-label=\"Summary\"><table class=\"times summary\">\n\
         <caption>Processor time to an error of {}{NOTE}</caption>\n\
         <thead><tr><th scope=\"col\">scene</th>{}</tr></thead>\n<tbody>\n",
        level(target),
        heads.collect::<String>()
    );
    for (index, scene) in study.scenes.iter().enumerate() {
        let whole = scene
            .series
            .iter()
            .filter(|s| s.sweep.is_none() && s.layers.is_empty());
        let best = whole
            .filter_map(|s| seconds(s, target))
            .min_by(f64::total_cmp);
        let cells = methods
            .iter()
            .map(|method| summary_cell(scene, method, target, best));
        out += &format!(
            "<tr><th scope=\"row\"><a href=\"#scene-{index}\">{}</a></th>{}</tr>\n",
            escape(&scene.name),
            cells.collect::<String>()
        );
    }
    out + "</tbody></table></div>\n"
}

fn summary_cell(scene: &SceneStudy, method: &str, target: f64, best: Option<f64>) -> String {
    let of_method = || {
        let all = scene.series.iter().filter(|s| s.sweep.is_none());
        all.filter(|s| s.method == method)
    };
    // A series of the whole picture says more than one of some layers.
    let series = of_method()
        .find(|s| s.layers.is_empty())
        .or_else(|| of_method().next());
    match series {
        Some(series) if series.layers.is_empty() => cell(series, target, best),
        Some(series) => {
            cell(series, target, None).replacen("</td>", &format!("{}</td>", mark(series)), 1)
        }
        None if scene.absent.iter().any(|a| a.method == method) => {
            "<td class=\"none\">absent</td>".to_owned()
        }
        None => "<td class=\"none\">–</td>".to_owned(),
    }
}

/// The legend of a plot: looks, names, slopes; the page makes switches of it.
pub(super) fn legend(curves: &[Curve]) -> String {
    let mut out = "<ul class=\"legend\">\n".to_owned();
    for curve in curves {
        out += &format!(
            "<li><label><input type=\"checkbox\" class=\"js\" data-s=\"{}\" checked> {}<span>{}{}</span></label> \
             <small>{}</small></li>\n",
            curve.place,
            key(curve.number),
            escape(&curve.name),
            mark(curve.series),
            fit_words(curve.series.fit.as_ref())
        );
    }
    out + "</ul>\n"
}
