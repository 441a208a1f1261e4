//! The part of the page about one scene.

use super::{
    curves::{Plot, Room},
    effects,
    figures::Figures,
    gallery::Gallery,
    palette::Medium,
    strips::{link, pictures},
    tables::{legend, mark, times},
    words::{counted, duration, escape, per_cent},
};
use crate::study::{SceneStudy, Series, Truth, TruthKind};

/// The section of scene `index`.
pub(super) fn section(
    index: usize,
    scene: &SceneStudy,
    figures: &Figures,
    gallery: &Gallery,
) -> String {
    let mut out = format!(
        "<section class=\"scene\" id=\"scene-{index}\" aria-labelledby=\"name-{index}\">\n\
         <h2 id=\"name-{index}\">{}</h2>\n<p class=\"title\">{}</p>\n{}",
        escape(&scene.name),
        escape(&scene.title),
        truth(scene)
    );
    if scene.series.is_empty() {
        out += "<p>No method has a curve in this scene.</p>\n";
    }
    if !figures.error.curves.is_empty() {
        out += "<h3>Error against time</h3>\n";
        out += &plot(&figures.error, &figures.error_file);
        out += &times("Processor time to an error", &figures.error.curves);
        out += &blind(scene);
    }
    out += &pictures(scene, gallery);
    out += &noise_and_bias(figures);
    out += &sweeps(figures);
    if !scene.effects.is_empty() {
        out += &effects::section(&scene.effects);
    }
    out += &absent(scene);
    out + "</section>\n"
}

/// What the pictures are judged by.
fn truth(scene: &SceneStudy) -> String {
    let Truth {
        kind,
        words,
        error,
        cpu_seconds,
        ..
    } = &scene.truth;
    let kind = match kind {
        TruthKind::ClosedForm => "a formula",
        TruthKind::Given => "a picture that was given",
        TruthKind::Made => "long runs of an independent method",
    };
    let mut facts = Vec::new();
    if let Some(seconds) = cpu_seconds {
        facts.push(format!("{} of processor time", duration(*seconds)));
    }
    facts.push(match error {
        Some(error) if error.is_finite() => format!("its own error <b>{}</b>", per_cent(*error, 2)),
        _ => "its own error is not known".to_owned(),
    });
    let [width, height] = scene.resolution;
    format!(
        "<p class=\"truth\"><b>Truth:</b> {kind}. {} <span class=\"quiet\">({}; pictures of {width} × {height} pixels)</span></p>\n",
        escape(words),
        facts.join("; ")
    )
}

/// A plot in both widths, its legend, and the file for papers.
fn plot(plot: &Plot, file: &str) -> String {
    let mut out = format!(
        "<figure class=\"chart\">\n<div class=\"stage\">{}{}</div>\n{}",
        plot.draw(Medium::Page, Room::Wide),
        plot.draw(Medium::Page, Room::Narrow),
        legend(&plot.curves)
    );
    let left_out = plot.left_out();
    if left_out > 0 {
        out += &format!(
            "<p class=\"quiet\">{} not drawn: the error or the time is zero, infinite or not a number.</p>\n",
            counted(left_out, "run is", "runs are")
        );
    }
    out + &format!(
        "<figcaption>For papers: {}</figcaption>\n</figure>\n",
        link(file)
    )
}

/// What methods do not see or blur; a dagger marks those that were judged by
/// some layers only.
fn blind(scene: &SceneStudy) -> String {
    let some = scene
        .series
        .iter()
        .filter(|s| !s.layers.is_empty() || !s.blind_spots.is_empty());
    let words = |s: &Series| {
        let layers = if s.layers.is_empty() {
            String::new()
        } else {
            format!(" Judged by {} only.", escape(&s.layers.join(", ")))
        };
        format!(
            "<li><b>{}{}</b>: {}{layers}</li>\n",
            escape(&s.label),
            mark(s),
            escape(&s.blind_spots.join(" "))
        )
    };
    let items: String = some.map(words).collect();
    if items.is_empty() {
        return items;
    }
    format!("<ul class=\"notes\">\n{items}</ul>\n")
}

fn noise_and_bias(figures: &Figures) -> String {
    let both = [Room::Wide, Room::Narrow].map(|room| figures.split(Medium::Page, room));
    let [Some(wide), Some(narrow)] = both else {
        return String::new();
    };
    format!(
        "<h3>Noise and bias</h3>\n\
         <p>Noise is what differs from seed to seed, bias what all seeds have in common. \
         Filled markers and solid lines: noise. Hollow markers and dashed lines: bias; \
         one that sits on the axis is too small to be told from nothing.</p>\n\
         <figure class=\"chart\">\n<div class=\"stage\">{wide}{narrow}</div>\n\
         <figcaption>For papers: {}</figcaption>\n</figure>\n",
        link(&figures.split_file)
    )
}

fn sweeps(figures: &Figures) -> String {
    if figures.sweeps.is_empty() {
        return String::new();
    }
    let mut out = "<h3>What each setting buys</h3>\n".to_owned();
    for sweep in &figures.sweeps {
        out += &format!(
            "<div class=\"sweep\"><h4>{} of {}</h4>\n{}{}</div>\n",
            escape(sweep.setting),
            escape(sweep.method),
            plot(&sweep.plot, &sweep.file),
            times(
                &format!("Time to an error by {}", sweep.setting),
                &sweep.plot.curves
            )
        );
    }
    out
}

fn absent(scene: &SceneStudy) -> String {
    if scene.absent.is_empty() {
        return String::new();
    }
    let mut out = "<h3>Methods without a curve</h3>\n<ul class=\"notes\">\n".to_owned();
    for absent in &scene.absent {
        out += &format!(
            "<li><b>{}</b>: {}</li>\n",
            escape(&absent.method),
            escape(&absent.reason)
        );
    }
    out + "</ul>\n"
}
