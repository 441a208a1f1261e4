//! The report of a study: a page, a table, and plots for papers.
//!
//! `index.html` is a single file that needs nothing else: no network, no
//! script for what matters (plots are drawn here; its script adds hovering,
//! switches and the slider). Pictures are part of it up to 15 MiB of PNG files;
//! the rest are linked where they lie. `study.csv` has a line for each run,
//! `effects.csv` one for each effect, `table.md` the tables for a text in
//! Markdown, and `plots/` one SVG for each plot, on white, without script. The same study and
//! the same pictures give the same bytes.
//!
//! What comes from the record is data, never markup: it passes `words::escape`
//! on its way into a page or a plot. Numbers may be anything; what has no place
//! on a logarithmic axis is counted and said, not drawn. Paths of pictures may
//! lead nowhere or outside; then the page says so in their place.

mod csv;
mod curves;
mod drawing;
mod effects;
mod figures;
mod frame;
mod gallery;
mod levels;
mod markdown;
mod page;
mod palette;
mod scale;
mod scene;
mod split;
mod strips;
mod tables;
mod words;

use std::{fs, path::Path};

use self::{
    figures::{Figures, stems},
    gallery::Gallery,
};
use super::Study;
use crate::film::{OutputError, atomic::write_whole};

/// Writes the report of `study` into `directory`, where its pictures are:
/// `study.csv`, `effects.csv`, `table.md`, `plots/*.svg`, and last `index.html`. Each file is written whole
/// or not at all; others are left alone.
///
/// # Errors
/// See [`OutputError`]. Pictures that are missing are no error: the page says
/// so in their place.
pub fn write(study: &Study, directory: &Path) -> Result<(), OutputError> {
    let put = |name: &str, text: &str| {
        write_whole(&directory.join(name), |file| {
            file.write_all(text.as_bytes())
        })
    };
    put("study.csv", &csv::table(study))?;
    put("effects.csv", &effects::table(study))?;
    put("table.md", &markdown::tables(study))?;
    let methods = tables::methods(study);
    let stems = stems(study.scenes.iter().map(|s| s.name.as_str()));
    let scenes = study.scenes.iter().zip(&stems);
    let figures: Vec<Figures> = scenes
        .map(|(scene, stem)| Figures::new(scene, &methods, stem))
        .collect();
    let plots = directory.join("plots");
    fs::create_dir_all(&plots).map_err(|source| OutputError::Io {
        path: plots,
        action: "making the directory",
        source,
    })?;
    for (name, svg) in figures.iter().flat_map(Figures::files) {
        put(&name, &svg)?;
    }
    let galleries = Gallery::load_all(study, directory);
    put("index.html", &page::document(study, &figures, &galleries))
}
