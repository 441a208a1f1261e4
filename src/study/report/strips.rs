//! Pictures side by side, their errors by pixel, and a slider between two.

use super::{
    gallery::{Gallery, address},
    levels::{Alike, Level, levels},
    words::{duration, escape, level, per_cent},
};
use crate::study::{MAP_TOP, Picture, SceneStudy};

/// The strips and the slider of a scene; empty if it has no pictures.
pub(super) fn pictures(scene: &SceneStudy, gallery: &Gallery) -> String {
    let has_pictures = scene.series.iter().any(|s| !s.pictures.is_empty());
    if !has_pictures && scene.truth.picture.is_none() {
        return String::new();
    }
    let mut out = "<h3>Pictures</h3>\n".to_owned();
    out += &gallery.definitions();
    out += &slider(scene, gallery);
    out += &strip(scene, gallery, Alike::Time);
    out += &strip(scene, gallery, Alike::Error);
    if has_pictures {
        out += &format!(
            "<p class=\"scale\"><span>Errors by pixel: 0</span> <i aria-hidden=\"true\"></i> <span>{} and more</span></p>\n",
            level(MAP_TOP)
        );
    }
    let [embedded, linked, missing] = gallery.counts();
    out += &format!("<p class=\"quiet\">{embedded} pictures of this scene are part of this file.");
    if linked > 0 {
        out += &format!(
            " {linked} more are not, to bound its size; they show as long as the report’s folder is beside it."
        );
    }
    if missing > 0 {
        out += &format!(" {missing} are missing.");
    }
    out + "</p>\n"
}

/// What a picture says of itself.
fn caption(label: &str, picture: &Picture) -> String {
    format!(
        "{label} · {} · {}",
        duration(picture.cpu_seconds),
        per_cent(picture.error, 2)
    )
}

/// A picture, or the reason why there is none.
fn shot(gallery: &Gallery, file: &str, words: &str, class: &str) -> String {
    let [width, height] = gallery.size();
    let words = escape(words);
    match gallery.id(file) {
        Ok(id) => format!(
            "<svg class=\"shot {class}\" viewBox=\"0 0 {width} {height}\" role=\"img\" aria-label=\"{words}\">\
             <use href=\"#{id}\"/></svg>"
        ),
        Err(reason) => format!(
            "<div class=\"shot {class} gap\" style=\"aspect-ratio:{width}/{height}\" role=\"img\" \
             aria-label=\"{words}: missing\"><span>{} {reason}</span></div>",
            if file.is_empty() {
                "no file".to_owned()
            } else {
                escape(file)
            }
        ),
    }
}

/// The pictures of about equal time or error.
fn strip(scene: &SceneStudy, gallery: &Gallery, alike: Alike) -> String {
    let (levels, first) = levels(scene, alike);
    if levels.is_empty() {
        return String::new();
    }
    let title = match alike {
        Alike::Time => "At about equal time",
        Alike::Error => "At about equal error",
    };
    let mut out = format!("<div class=\"strips\" data-first=\"{first}\"><h4>{title}</h4>\n");
    if levels.len() > 1 {
        out += &format!("<div class=\"choice js\" role=\"group\" aria-label=\"{title}\">\n");
        for (index, level) in levels.iter().enumerate() {
            out += &format!(
                "<button type=\"button\" aria-pressed=\"{}\">{}</button>\n",
                index == first,
                words(alike, level)
            );
        }
        out += "</div>\n";
    }
    for level in &levels {
        out += &row(scene, gallery, alike, level);
    }
    out + "</div>\n"
}

fn words(alike: Alike, at: &Level) -> String {
    match alike {
        Alike::Time => duration(at.about),
        Alike::Error => per_cent(at.about, 2),
    }
}

fn row(scene: &SceneStudy, gallery: &Gallery, alike: Alike, level: &Level) -> String {
    let mut out = format!(
        "<div class=\"row\"><h5>about {}</h5><div class=\"shots\">\n",
        words(alike, level)
    );
    if let Some(truth) = &scene.truth.picture {
        let picture = shot(gallery, truth, "The truth", "seen whole");
        out += &format!("<figure>{picture}<figcaption><b>truth</b></figcaption></figure>\n");
    }
    for (_, series, picture) in &level.shots {
        let words = caption(&series.label, picture);
        let picked = gallery.id(&picture.file).unwrap_or_default();
        out += &format!(
            "<figure>{}{}<figcaption><b>{}</b> {} · <b>{}</b> error \
             <button type=\"button\" class=\"js pick\" data-pick=\"{picked}\" aria-label=\"Compare: {}\"{}>compare</button>\
             </figcaption></figure>\n",
            shot(gallery, &picture.file, &words, "seen"),
            shot(gallery, &picture.map, &format!("Errors of {words}"), "map"),
            escape(&series.label),
            duration(picture.cpu_seconds),
            per_cent(picture.error, 2),
            escape(&words),
            if picked.is_empty() { " disabled" } else { "" },
        );
    }
    out + "</div></div>\n"
}

/// Two pictures, one over the other, with a border that can be moved.
fn slider(scene: &SceneStudy, gallery: &Gallery) -> String {
    let (levels, first) = levels(scene, Alike::Time);
    let before = levels
        .get(first)
        .and_then(|l| l.shots.first())
        .map(|s| &s.2.file);
    let truth = scene.truth.picture.as_ref();
    let choice = |picked: Option<&String>, side: &str| {
        format!(
            "<label>{side} <select data-side=\"{}\">{}</select></label>",
            side.to_lowercase(),
            options(scene, gallery, picked.map(String::as_str))
        )
    };
    let id = |file: Option<&String>| file.and_then(|f| gallery.id(f).ok());
    let any = gallery.counts();
    let (left, right) = match (id(before), id(truth)) {
        _ if any[0] + any[1] == 0 => return String::new(),
        (Some(left), Some(right)) => (left, right),
        (Some(one), None) | (None, Some(one)) => (one.clone(), one),
        (None, None) => return String::new(),
    };
    let [width, height] = gallery.size();
    let pane = |side: &str, id: &str| {
        format!(
            "<svg class=\"{side}\" viewBox=\"0 0 {width} {height}\" aria-hidden=\"true\"><use href=\"#{id}\"/></svg>"
        )
    };
    let [choice_left, choice_right] = [choice(before, "Left"), choice(truth, "Right")];
    format!(
        "<div class=\"viewer js\" data-width=\"{width}\" data-height=\"{height}\">\n\
         <div class=\"choose\">{choice_left}{choice_right}</div>\n\
         <div class=\"panes\" style=\"aspect-ratio:{width}/{height};--wide:{width}\">{}{}<span class=\"border\"></span></div>\n\
         <input type=\"range\" min=\"0\" max=\"100\" step=\"0.5\" value=\"50\" aria-label=\"Border between the left and the right picture\">\n\
         <div class=\"zoom\" role=\"group\" aria-label=\"Zoom\"><button type=\"button\" data-zoom=\"out\" aria-label=\"Smaller\">−</button>\
         <output>1×</output><button type=\"button\" data-zoom=\"in\" aria-label=\"Larger\">+</button>\
         <button type=\"button\" data-zoom=\"all\">whole</button>\
         <span class=\"quiet\">Drag the border. When enlarged, drag the picture to move it; arrow keys move it, too.</span></div>\n</div>\n",
        pane("left", &left),
        pane("right", &right)
    )
}

/// All pictures to choose from.
fn options(scene: &SceneStudy, gallery: &Gallery, picked: Option<&str>) -> String {
    let option = |file: &str, words: &str| match gallery.id(file) {
        Ok(id) => format!(
            "<option value=\"{id}\"{}>{}</option>",
            if picked == Some(file) {
                " selected"
            } else {
                ""
            },
            escape(words)
        ),
        Err(_) => String::new(),
    };
    let mut out = scene
        .truth
        .picture
        .as_ref()
        .map_or(String::new(), |f| option(f, "truth"));
    let all = || {
        scene
            .series
            .iter()
            .flat_map(|s| s.pictures.iter().map(move |p| (s, p)))
    };
    for (series, picture) in all() {
        out += &option(&picture.file, &caption(&series.label, picture));
    }
    out += "<optgroup label=\"errors by pixel\">";
    for (series, picture) in all() {
        out += &option(
            &picture.map,
            &format!("errors: {}", caption(&series.label, picture)),
        );
    }
    out + "</optgroup>"
}

/// A link to a file beside the page.
pub(super) fn link(file: &str) -> String {
    format!(
        "<a href=\"{}\">{}</a>",
        escape(&address(file)),
        escape(file)
    )
}
