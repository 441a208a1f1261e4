//! Effects as a table of numbers, and the tables for texts.

use crate::files::{read, records, written};
use crate::fixture::{alone, study};

#[test]
fn the_effects_are_the_data() {
    let mut study = study();
    study.scenes[1].name = "a \"b\", c".to_owned();
    let mut lines = records(&read(written(&study).path(), "effects.csv")).into_iter();
    let head = lines.next().unwrap();
    for scene in &study.scenes {
        for effect in &scene.effects {
            let line = lines.next().unwrap();
            let at = |name: &str| &line[head.iter().position(|h| h == name).unwrap()];
            let number = |name: &str| at(name).parse::<f64>().ok();
            assert_eq!((at("scene"), at("effect")), (&scene.name, &effect.name));
            assert_eq!(number("light"), Some(effect.light));
            assert_eq!(number("light_error"), Some(effect.light_error));
            assert_eq!(number("with_error"), effect.with_error);
            assert_eq!(number("without_error"), effect.without_error);
            assert_eq!(number("with_seconds"), Some(effect.with_seconds));
            assert_eq!(number("without_seconds"), Some(effect.without_seconds));
        }
    }
    assert_eq!(lines.next(), None);
}

/// The page tells the share with its uncertainty, and what cannot be told from
/// nought as such.
#[test]
fn the_page_has_the_effects() {
    let study = alone(study().scenes.swap_remove(0));
    let page = read(written(&study).path(), "index.html").replace('\u{a0}', " ");
    let table = page.split("aria-label=\"Effects\"").nth(1).unwrap();
    let table = table.split("</table>").next().unwrap();
    let row = |name: &str| {
        let rows = table.split("<tr>").find(|r| r.contains(name)).unwrap();
        let text = rows
            .split('<')
            .map(|part| part.split_once('>').map_or("", |p| p.1));
        text.collect::<Vec<_>>()
            .join(" ")
            .split_whitespace()
            .collect::<Vec<_>>()
            .join(" ")
    };
    assert_eq!(
        row("caustics"),
        "light of caustics 27 % ± 0.2 % 3.1 % 54 % 10 s 7.6 s 24 % of the time"
    );
    assert!(row("glints").starts_with("light of glints none beyond ± 0.4 % 3.1 % not known 10 s"));
}

/// The table for texts has a line for each curve, with the same times as the
/// data.
#[test]
fn a_table_for_texts() {
    let mut study = study();
    study.scenes[0].name = "a|b`c".to_owned();
    let text = read(written(&study).path(), "table.md");
    let lines: Vec<Vec<&str>> = text
        .lines()
        .filter(|line| line.starts_with("| "))
        .map(|line| line.split('|').map(str::trim).collect())
        .collect();
    let head = &lines[0];
    assert_eq!(&head[1..4], ["scene", "method", "10 %"]);
    let curves: usize = study.scenes.iter().map(|s| s.series.len()).sum();
    let effects: usize = study.scenes.iter().map(|s| s.effects.len()).sum();
    assert_eq!(lines.len(), 2 + curves + effects);
    assert!(lines[..=curves].iter().all(|line| line.len() == head.len()));
    assert_eq!(lines[1][1], "`a b c`");
    // The laws of the fixture, as `times_are_told_apart` has them.
    assert_eq!(&lines[1][2..4], ["photon", "0.20"]);
    let path = lines.iter().find(|line| line[2] == "path").unwrap();
    assert_eq!(path[3], "~360", "beyond the last point");
    let whitted = lines.iter().find(|line| line[2].starts_with("whitted"));
    let whitted = whitted.unwrap();
    assert_eq!((whitted[2], whitted[6]), ("whitted †", "-"));
    let caustics = lines.iter().find(|line| line[2] == "light of caustics");
    assert_eq!(
        caustics.unwrap()[3..8],
        ["27 % ± 0.20 %", "3.1 %", "54 %", "10", "7.6"]
    );
}
