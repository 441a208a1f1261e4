//! The page as a whole.

use super::{
    csv,
    figures::Figures,
    gallery::Gallery,
    palette, scene,
    tables::{headline, summary},
    words::{counted, escape, level},
};
use crate::study::Study;

const STYLE: &str = include_str!("report.css");
const SCRIPT: &str = include_str!("report.js");

/// The document. Figures and galleries are those of the scenes, in their order.
pub(super) fn document(study: &Study, figures: &[Figures], galleries: &[Gallery]) -> String {
    let names: Vec<&str> = study.scenes.iter().map(|s| s.name.as_str()).collect();
    let title = match names.as_slice() {
        [one] => format!("Error against time: {one}"),
        _ => format!(
            "Error against time: {}",
            counted(names.len(), "scene", "scenes")
        ),
    };
    let title = escape(&title);
    let parts = study.scenes.iter().zip(figures).zip(galleries).enumerate();
    let sections: String = parts
        .map(|(index, ((of, figures), gallery))| scene::section(index, of, figures, gallery))
        .collect();
    format!(
        "<!doctype html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n\
         <meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n\
         <meta http-equiv=\"Content-Security-Policy\" content=\"default-src 'none'; \
         img-src data: 'self' file:; style-src 'unsafe-inline'; script-src 'unsafe-inline'; \
         base-uri 'none'; form-action 'none'\">\n\
         <meta name=\"generator\" content=\"{software}\">\n<title>{title}</title>\n\
         <style>\n{colours}{STYLE}</style>\n</head>\n<body>\n\
         <header>{theme}<h1>{title}</h1>\n{facts}</header>\n<main>\n{top}{sections}</main>\n\
         <footer>{raw}</footer>\n<script>\n{SCRIPT}</script>\n</body>\n</html>\n",
        software = escape(&study.software),
        colours = palette::style_sheet(),
        facts = facts(study),
        theme = THEME,
        top = top(study),
        raw = raw(),
    )
}

/// The switch of colours; it works with the script only.
const THEME: &str = "<div class=\"theme js\" role=\"group\" aria-label=\"Colours\">\
    <button type=\"button\" data-theme=\"\" aria-pressed=\"true\">auto</button>\
    <button type=\"button\" data-theme=\"light\" aria-pressed=\"false\">light</button>\
    <button type=\"button\" data-theme=\"dark\" aria-pressed=\"false\">dark</button></div>\n";

fn facts(study: &Study) -> String {
    let machine = &study.machine;
    format!(
        "<p class=\"facts\">{} on {} ({}, {} used), {}. Finished {}.</p>\n",
        escape(&study.software),
        escape(&machine.processor),
        counted(machine.cores as usize, "core", "cores"),
        counted(machine.threads as usize, "thread", "threads"),
        escape(&machine.system),
        escape(&finished(&study.made))
    )
}

/// A date and time in UTC for reading, to the minute; other words as they are.
fn finished(made: &str) -> String {
    match (
        made.get(..10),
        made.get(10..11),
        made.get(11..16),
        made.ends_with('Z'),
    ) {
        (Some(date), Some("T"), Some(time), true) => format!("{date}, {time} UTC"),
        _ => made.to_owned(),
    }
}

fn top(study: &Study) -> String {
    if study.scenes.is_empty() {
        return "<p>This study has no scenes.</p>\n".to_owned();
    }
    let target = headline(study).map_or(String::new(), |t| {
        format!(" The table shows what an error of {} costs.", level(t))
    });
    format!(
        "<section aria-labelledby=\"summary\"><h2 id=\"summary\">Summary</h2>\n{}{}\
         <details open><summary>How to read this page</summary>\n\
         <p>Every dot of a plot is one rendered picture: how far it is from the truth against the \
         processor time that it took, both on logarithmic scales. Further down and further left is \
         better. The <em>error</em> is relative: the root of the mean over pixels and channels of \
         (x − r)² / (r² + 0.01 m²), where x is the picture, r the truth, and m the truth’s mean.{target}</p>\n\
         <p>Where only noise is left, a curve falls with slope −0.5: half the error takes four times \
         as long. A steeper curve gains with every second; one that lies flat has met its bias, or the \
         error of the truth. In the tables the number beneath a time says how many times the best it is, and \
         <q>not reached</q> means that not even the fitted line gets there. \
         † marks methods that do not see everything: only the layers they see were judged, and they \
         take no part in the comparison.</p></details>\n</section>\n",
        contents(study),
        summary(study)
    )
}

/// Links to the scenes, where the table does not have them.
fn contents(study: &Study) -> String {
    if headline(study).is_some() {
        return String::new();
    }
    let link = |(index, scene): (usize, &crate::study::SceneStudy)| {
        format!(
            "<li><a href=\"#scene-{index}\">{}</a></li>",
            escape(&scene.name)
        )
    };
    let links: String = study.scenes.iter().enumerate().map(link).collect();
    format!("<ul>{links}</ul>\n")
}

/// Where the numbers are, and what the table's columns mean.
fn raw() -> String {
    let mut columns = String::new();
    for (name, meaning) in csv::COLUMNS {
        columns += &format!(
            "<tr><th scope=\"row\"><code>{name}</code></th><td>{}</td></tr>\n",
            escape(meaning)
        );
    }
    format!(
        "<h2>The numbers</h2>\n<p><a href=\"study.csv\">study.csv</a> has a line for each run, \
         <a href=\"study.json\">study.json</a> everything that this page shows.</p>\n\
         <details><summary>Columns of study.csv</summary><div class=\"scroll\" role=\"region\" \
         tabindex=\"0\" aria-label=\"Columns of study.csv\"><table class=\"columns\">\n\
         <thead><tr><th scope=\"col\">column</th><th scope=\"col\">meaning</th></tr></thead>\n\
         <tbody>\n{columns}</tbody></table></div></details>\n"
    )
}
