//! The files: the table reads back as the data, names are harmless, bytes are
//! the same, and nothing is too odd to be written.

use std::{fs, path::Path};

use nephroid::study::{Study, report};
use serde_json::Value;

use crate::fixture::{alone, put_pictures, study};

/// A table in the format of RFC 4180, read by its rules.
pub(crate) fn records(text: &str) -> Vec<Vec<String>> {
    let (mut records, mut record, mut field) = (Vec::new(), Vec::new(), String::new());
    let (mut quoted, mut chars) = (false, text.chars().peekable());
    while let Some(c) = chars.next() {
        match c {
            '"' if quoted && chars.peek() == Some(&'"') => field.extend(chars.next()),
            '"' => quoted = !quoted,
            ',' if !quoted => record.push(std::mem::take(&mut field)),
            '\r' if !quoted && chars.peek() == Some(&'\n') => {
                chars.next();
                record.push(std::mem::take(&mut field));
                records.push(std::mem::take(&mut record));
            }
            _ => field.push(c),
        }
    }
    assert!(
        !quoted && field.is_empty() && record.is_empty(),
        "the last line has an end"
    );
    records
}

pub(crate) fn read(directory: &Path, name: &str) -> String {
    fs::read_to_string(directory.join(name)).unwrap()
}

pub(crate) fn written(study: &Study) -> tempfile::TempDir {
    let directory = tempfile::tempdir().unwrap();
    report::write(study, directory.path()).unwrap();
    directory
}

#[test]
fn the_table_is_the_data() {
    let mut study = study();
    study.scenes[1].name = "a \"b\", c\r\nd".to_owned();
    study.scenes[1].series[0].points[0].runs[0].relmse = f64::NAN;
    let directory = written(&study);
    let mut lines = records(&read(directory.path(), "study.csv")).into_iter();
    let head = lines.next().unwrap();
    let mut count = 0;
    for scene in &study.scenes {
        for series in &scene.series {
            for point in &series.points {
                for run in &point.runs {
                    let line = lines.next().unwrap();
                    let at = |name: &str| &line[head.iter().position(|h| h == name).unwrap()];
                    let is = |name: &str, value: f64| {
                        let found: f64 = at(name).parse().unwrap();
                        assert!(
                            found == value || (found.is_nan() && value.is_nan()),
                            "{name}"
                        );
                    };
                    let sweep = series.sweep.as_ref();
                    assert_eq!(at("scene"), &scene.name);
                    assert_eq!(at("series"), &series.label);
                    assert_eq!(at("method"), &series.method);
                    assert_eq!(at("setting"), sweep.map_or("", |s| &s.name));
                    assert_eq!(at("value"), sweep.map_or("", |s| &s.value));
                    assert_eq!(at("layers"), &series.layers.join(" "));
                    assert_eq!(at("passes"), &point.passes.to_string());
                    assert_eq!(at("seed"), &run.seed.to_string());
                    is("wall_seconds", run.wall_seconds);
                    is("cpu_seconds", run.cpu_seconds);
                    is("error", run.relmse.sqrt());
                    is("relmse", run.relmse);
                    is("relmse_trimmed", run.relmse_trimmed);
                    is("rmse", run.rmse);
                    is("mean_ratio", run.mean_ratio);
                    is("flip", run.flip);
                    assert_eq!(
                        at("stated"),
                        &run.stated.map_or(String::new(), |s| s.to_string())
                    );
                    assert_eq!(line.len(), head.len());
                    count += 1;
                }
            }
        }
    }
    assert!(lines.next().is_none() && count > 300, "{count}");
}

#[test]
fn the_same_bytes() {
    let study = study();
    let [a, b] = [(); 2].map(|()| {
        let directory = tempfile::tempdir().unwrap();
        put_pictures(&study, directory.path());
        report::write(&study, directory.path()).unwrap();
        directory
    });
    let mut names: Vec<String> = vec!["index.html", "study.csv", "effects.csv", "table.md"]
        .into_iter()
        .map(str::to_owned)
        .collect();
    for file in fs::read_dir(a.path().join("plots")).unwrap() {
        names.push(format!(
            "plots/{}",
            file.unwrap().file_name().to_str().unwrap()
        ));
    }
    // Three scenes with two plots each, one of them with a sweep.
    assert_eq!(names.len(), 4 + 7, "{names:?}");
    for name in names {
        assert_eq!(read(a.path(), &name), read(b.path(), &name), "{name}");
    }
}

const HOSTILE: &str =
    "<script>window.harm=1</script>'\"><img src=x onerror=window.harm=1>&amp;]]>{{\u{0}";

/// Every text of the data in turn becomes an attack.
fn spoil(value: &mut Value, key: &str) {
    match value {
        // The kind of a truth is one of three words.
        Value::String(text) if key != "kind" => text.insert_str(0, HOSTILE),
        Value::Array(items) => items.iter_mut().for_each(|item| spoil(item, key)),
        Value::Object(fields) => fields.iter_mut().for_each(|(key, item)| spoil(item, key)),
        _ => {}
    }
}

/// The study with an attack in every text.
pub(crate) fn hostile() -> Study {
    let mut value = serde_json::to_value(study()).unwrap();
    spoil(&mut value, "");
    serde_json::from_value(value).unwrap()
}

#[test]
fn names_are_harmless() {
    let directory = written(&hostile());
    let mut texts = ["index.html", "table.md"]
        .map(|name| read(directory.path(), name))
        .to_vec();
    for file in fs::read_dir(directory.path().join("plots")).unwrap() {
        let file = file.unwrap();
        let name = file.file_name().into_string().unwrap();
        assert!(
            name.chars()
                .all(|c| c.is_ascii_alphanumeric() || "-_.".contains(c)),
            "{name}"
        );
        texts.push(fs::read_to_string(file.path()).unwrap());
    }
    for text in texts {
        assert!(!text.contains("<script>window"), "a script got through");
        assert!(!text.contains("<img"), "an element got through");
        assert!(
            !text.contains("'\"><") && !text.contains('\u{0}'),
            "a quote got through"
        );
        assert!(
            text.contains("&lt;script&gt;window"),
            "the text is shown as it is"
        );
    }
}

/// A record cannot make the page show files from elsewhere, nor others than PNG.
#[test]
fn only_pictures_beside_the_report_are_taken() {
    let directory = tempfile::tempdir().unwrap();
    let report = directory.path().join("report");
    fs::create_dir(&report).unwrap();
    let outside = directory.path().join("secret.png");
    let mut study = alone(study().scenes.swap_remove(1));
    put_pictures(&study, &report);
    fs::copy(report.join("pictures/truth-1.png"), &outside).unwrap();
    fs::write(report.join("words.png"), "not a picture, but a SECRET").unwrap();
    let pictures = &mut study.scenes[0].series[0].pictures;
    pictures[0].file = "../secret.png".to_owned();
    pictures[0].map = outside.to_str().unwrap().to_owned();
    pictures[1].file = "words.png".to_owned();
    pictures[1].map = "pictures".to_owned();
    pictures[2].file = "pictures/../pictures/truth-1.png".to_owned();
    pictures[2].map = String::new();
    study.scenes[0].truth.picture = Some("gone.png".to_owned());
    report::write(&study, &report).unwrap();
    let page = read(&report, "index.html");
    assert!(page.contains("gone.png is not there"));
    assert!(page.contains("secret.png lies outside"));
    assert!(page.contains("words.png is not a PNG"));
    assert!(page.contains("pictures cannot be read"));
    let shown = page.matches("<image ").count();
    let named: usize = study.scenes[0]
        .series
        .iter()
        .map(|s| 2 * s.pictures.len())
        .sum();
    assert_eq!(shown, named - 6);
}

/// What does not fit into the page is linked, and the page says so.
#[test]
fn the_page_is_bounded() {
    let study = alone(study().scenes.swap_remove(1));
    let directory = tempfile::tempdir().unwrap();
    put_pictures(&study, directory.path());
    // A PNG may have anything behind its end.
    let pictures: Vec<_> = study.scenes[0]
        .series
        .iter()
        .flat_map(|s| &s.pictures)
        .collect();
    for picture in &pictures {
        let path = directory.path().join(&picture.file);
        let mut bytes = fs::read(&path).unwrap();
        bytes.resize(3 << 20, 0);
        fs::write(&path, bytes).unwrap();
    }
    report::write(&study, directory.path()).unwrap();
    let page = read(directory.path(), "index.html");
    assert!(page.len() < (21 << 20), "{}", page.len());
    let linked = page.matches("href=\"pictures/").count();
    assert!(linked > 0 && linked < 2 * pictures.len());
    assert!(page.contains(&format!("{linked} more are not, to bound its size")));
}

/// Nothing at all, scenes of nothing, numbers that are none.
#[test]
fn odd_studies_are_written() {
    let mut odd = study();
    odd.scenes.clear();
    assert!(read(written(&odd).path(), "index.html").contains("no scenes"));

    let mut odd = study();
    for (index, scene) in odd.scenes.iter_mut().enumerate() {
        match index {
            0 => {
                scene.series.clear();
                scene.effects.clear();
                scene.absent.clear();
                scene.truth.error = None;
                scene.truth.picture = None;
                scene.resolution = [0, 0];
            }
            1 => {
                for series in &mut scene.series {
                    series.points.clear();
                    series.times.clear();
                    series.pictures.clear();
                    series.fit = None;
                }
            }
            _ => {
                scene.truth.error = Some(f64::INFINITY);
                for effect in &mut scene.effects {
                    effect.with_seconds = 0.0;
                    effect.light = f64::NAN;
                    effect.with_error = Some(f64::INFINITY);
                }
                for series in &mut scene.series {
                    for (k, point) in series.points.iter_mut().enumerate() {
                        let value = [f64::NAN, 0.0, f64::INFINITY, -1.0][k % 4];
                        point.split = None;
                        for run in &mut point.runs {
                            run.relmse = value;
                        }
                    }
                    for picture in &mut series.pictures {
                        picture.error = f64::NAN;
                        picture.cpu_seconds = 0.0;
                    }
                    for time in &mut series.times {
                        time.cpu_seconds = Some(f64::NAN);
                        time.error = f64::NAN;
                    }
                    if let Some(fit) = &mut series.fit {
                        fit.slope = f64::NAN;
                        fit.slope_interval = [f64::NEG_INFINITY, f64::INFINITY];
                    }
                }
            }
        }
    }
    let directory = written(&odd);
    let page = read(directory.path(), "index.html");
    assert_eq!(page.matches("<section class=\"scene\"").count(), 3);
    for name in [
        "index.html",
        "plots/ring-error.svg",
        "plots/glass_sphere-error.svg",
    ] {
        let text = read(directory.path(), name);
        let numbers = text.split(['"', ' ', '(', ')', ',']);
        let lost = numbers
            .filter(|n| ["NaN", "inf", "-inf"].contains(n))
            .count();
        assert_eq!(lost, 0, "{name} has places that are no numbers");
    }
}

/// The times of the table, and which of them is the best.
#[test]
fn times_are_told_apart() {
    let study = alone(study().scenes.swap_remove(0));
    let page = read(written(&study).path(), "index.html");
    let table = page
        .split("<caption>Processor time to an error <")
        .nth(1)
        .unwrap();
    let table = table.split("</table>").next().unwrap();
    let row = |name: &str| {
        let rows = table
            .split("<tr>")
            .find(|r| r.contains(&format!("</svg>{name}")));
        let cells = rows.unwrap().split("<td").skip(1);
        cells
            .map(|c| {
                c.split("</td>")
                    .next()
                    .unwrap()
                    .split_once('>')
                    .unwrap()
                    .1
                    .replace('\u{a0}', " ")
            })
            .collect::<Vec<_>>()
    };
    // From the laws: (0.1 / 0.035)^(1 / -0.66) = 0.204 s, and so on; whitted's
    // own layers are compared with nobody's.
    assert_eq!(row("photon")[0], "<strong>0.20 s</strong>");
    assert_eq!(
        row("photon")[3],
        "<strong><em title=\"beyond the last point\">41 s</em><span class=\"unseen\"> beyond the last point</span></strong>"
    );
    assert!(row("path")[0].starts_with("<em title=\"beyond the last point\">6.0 min</em>"));
    assert!(row("path")[0].ends_with("<small>1800 ×</small>"));
    assert_eq!(row("sppm")[0], "1.2 s<small>6.1 ×</small>");
    assert_eq!(row("whitted")[3], "not reached");
    assert!(
        !row("whitted")[0].contains("strong"),
        "who runs alone does not win"
    );
}
