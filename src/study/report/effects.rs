//! What each effect brings and costs: a part of the page, and `effects.csv`.

use super::{
    csv::field,
    words::{digits, duration, escape, per_cent},
};
use crate::study::{Effect, Study};

/// The table of a scene's effects.
pub(super) fn section(effects: &[Effect]) -> String {
    let heads = [
        "effect",
        "share of the light",
        "error with it",
        "without it",
        "time with it",
        "without it",
        "what it adds",
    ]
    .map(|head| format!("<th scope=\"col\">{head}</th>"))
    .concat();
    let mut out = format!(
        "<h3>What each effect costs</h3>\n\
         <p>Eight passes of the renderer with everything, and without one effect at a time. \
         What brings no light finds the same with less noise.</p>\n\
         <div class=\"scroll\" role=\"region\" tabindex=\"0\" aria-label=\"Effects\"><table>\n\
         <caption>The same passes with and without each effect</caption>\n\
         <thead><tr>{heads}</tr></thead>\n<tbody>\n"
    );
    for effect in effects {
        let added = effect.with_seconds - effect.without_seconds;
        let share = added / effect.with_seconds;
        let cells = [
            bar(effect.light) + &share_of_light(effect),
            error(effect.with_error),
            error(effect.without_error),
            duration(effect.with_seconds),
            duration(effect.without_seconds),
            bar(share)
                + &if share.is_finite() {
                    format!("{} of the time", per_cent(share, 2))
                } else {
                    digits(added, 2) + " s"
                },
        ]
        .map(|cell| format!("<td>{cell}</td>"))
        .concat();
        out += &format!(
            "<tr><th scope=\"row\">{}</th>{cells}</tr>\n",
            escape(&effect.title)
        );
    }
    out + "</tbody></table></div>\n"
}

/// The share with its standard error, which says how many of its digits count;
/// of what is within twice that error of nought only the bound is told.
fn share_of_light(effect: &Effect) -> String {
    let Effect {
        light, light_error, ..
    } = *effect;
    if light.abs() <= 2.0 * light_error {
        return format!("none beyond ± {}", per_cent(2.0 * light_error, 1));
    }
    if light_error > 0.0 {
        return format!("{} ± {}", per_cent(light, 2), per_cent(light_error, 1));
    }
    per_cent(light, 2)
}

fn error(error: Option<f64>) -> String {
    error.map_or_else(|| "not known".to_owned(), |error| per_cent(error, 2))
}

/// A share as a bar.
fn bar(share: f64) -> String {
    let width = if share.is_nan() {
        0.0
    } else {
        share.clamp(0.0, 1.0)
    };
    format!(
        "<span class=\"bar\"><i style=\"width:{:.1}%\"></i></span>",
        100.0 * width
    )
}

/// All effects of a study, one a line.
pub(super) fn table(study: &Study) -> String {
    let mut out = "scene,effect,light,light_error,with_error,without_error,\
                   with_seconds,without_seconds\r\n"
        .to_owned();
    for scene in &study.scenes {
        for effect in &scene.effects {
            let known = |error: Option<f64>| error.map_or(String::new(), |e| e.to_string());
            let values = [
                field(&scene.name),
                field(&effect.name),
                effect.light.to_string(),
                effect.light_error.to_string(),
                known(effect.with_error),
                known(effect.without_error),
                effect.with_seconds.to_string(),
                effect.without_seconds.to_string(),
            ];
            out += &(values.join(",") + "\r\n");
        }
    }
    out
}
