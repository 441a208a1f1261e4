//! The page in a browser: what shows, what pointers, fingers and keys do.
//!
//! Chromium is looked for on the path, or where the variable `CHROME` says. If
//! there is none the test says so and passes, unless `NEPHROID_BROWSER_TESTS`
//! is `required`.

use std::{env, io::Write, path::Path};

use nephroid::study::{Run, Study, report};
use serde_json::{Value, json};

use crate::{
    devtools::{Browser, find},
    files::hostile,
    fixture::{put_pictures, study},
};

#[test]
fn the_page_works_in_a_browser() {
    let Some(program) = find() else {
        let demanded = env::var("NEPHROID_BROWSER_TESTS").is_ok_and(|v| v == "required");
        assert!(
            !demanded,
            "Chromium is required and was not found: install it or set CHROME"
        );
        // Past the test harness, which keeps what passing tests print.
        let words =
            "\nskipped: no Chromium was found to open the report (install it or set CHROME)\n";
        std::io::stderr().write_all(words.as_bytes()).unwrap();
        return;
    };
    let study = study();
    let directory = tempfile::tempdir().unwrap();
    put_pictures(&study, directory.path());
    report::write(&study, directory.path()).unwrap();
    let page = directory.path().join("index.html");
    let mut browser = Browser::start(&program);
    browser.screen(1200, 900, false);
    browser.taste("light", "");
    browser.open(&page);
    shows_the_data(&mut browser, &study);
    hovering(&mut browser, &study);
    walking_by_keys(&mut browser, &study);
    hiding_a_curve(&mut browser);
    sliding(&mut browser);
    enlarging(&mut browser);
    choosing_pictures(&mut browser);
    colours(&mut browser);
    names_for_all_controls(&mut browser);
    assert_eq!(browser.complaints(), Vec::<Value>::new());
    phone(&mut browser, &page, &study);
    printing(&mut browser, &page);
    without_script(&mut browser, &page);
    plots_are_well_formed(&mut browser, directory.path());
    hostile_names(&mut browser);
}

fn default_runs(study: &Study) -> Vec<(&str, u32, &Run)> {
    let series = study.scenes[0].series.iter().filter(|s| s.sweep.is_none());
    let points = series.flat_map(|s| s.points.iter().map(move |p| (s.label.as_str(), p)));
    points
        .flat_map(|(label, p)| p.runs.iter().map(move |r| (label, p.passes, r)))
        .collect()
}

fn shows_the_data(browser: &mut Browser, study: &Study) {
    let dots = browser.number("document.querySelectorAll('#scene-0 .chart .wide .dot').length");
    let split: usize = study.scenes[0]
        .series
        .iter()
        .filter(|s| s.sweep.is_none())
        .map(|s| 2 * s.points.len())
        .sum();
    let swept = |s: &&nephroid::study::Series| s.sweep.is_some() || s.label == "photon";
    let sweep: usize = study.scenes[0]
        .series
        .iter()
        .filter(swept)
        .flat_map(|s| &s.points)
        .map(|p| p.runs.len())
        .sum();
    assert_eq!(dots, (default_runs(study).len() + split + sweep) as f64);
    // All pictures are there and decoded: none is of size zero.
    let broken = browser.value(
        "Promise.all([...document.querySelectorAll('.store image')].map(async (node) => { \
         const image = new Image(); image.src = node.getAttribute('href'); \
         try { await image.decode(); return image.naturalWidth === 120; } catch { return false; } })) \
         .then((all) => [all.length, all.filter((good) => !good).length])",
    );
    let files = |s: &nephroid::study::SceneStudy| {
        1 + s.series.iter().map(|s| 2 * s.pictures.len()).sum::<usize>()
    };
    let wanted: usize = study.scenes.iter().map(files).sum();
    assert_eq!(broken, json!([wanted, 0]));
    let shown = "[...document.querySelectorAll('svg use')].every((u) => document.querySelector(u.getAttribute('href')))";
    assert_eq!(browser.value(shown), json!(true));
}

/// Numbers before a unit in what a dot says.
fn said(words: &str, unit: &str) -> f64 {
    let words = words.replace('\u{a0}', " ");
    let before = words.split(&format!(" {unit}")).next().unwrap();
    before.rsplit(' ').next().unwrap().parse().unwrap()
}

fn check_words(words: &str, (label, passes, run): (&str, u32, &Run)) {
    assert!(words.starts_with(&format!("{label} ·")), "{words}");
    assert!(words.contains(&format!("· seed {} ·", run.seed)), "{words}");
    assert_eq!(said(words, "pass"), f64::from(passes));
    let near = |a: f64, b: f64| (a / b - 1.0).abs() <= 0.005;
    assert!(near(said(words, "CPU s"), run.cpu_seconds), "{words}");
    assert!(near(said(words, "%"), 100.0 * run.relmse.sqrt()), "{words}");
}

const TIP: &str = "document.querySelector('#scene-0 .stage .tip').textContent";

fn hovering(browser: &mut Browser, study: &Study) {
    let runs = default_runs(study);
    browser.middle("#scene-0 .stage");
    // The first and last run of each series, and one in the middle.
    for index in (0..runs.len()).step_by(31).chain([0, 13, runs.len() - 1]) {
        let at = browser.value(&format!(
            "(() => {{ const b = document.querySelectorAll('#scene-0 .stage .wide .dot')[{index}].getBoundingClientRect(); \
             return [b.left + b.width / 2, b.top + b.height / 2]; }})()"
        ));
        let at = [0, 1].map(|k| at[k].as_f64().unwrap());
        browser.mouse("mouseMoved", at);
        let words = browser.text(TIP);
        assert!(!words.is_empty(), "nothing shows at {at:?}, dot {index}");
        check_words(&words, runs[index]);
    }
    browser.mouse("mouseMoved", [2.0, 2.0]);
    assert_eq!(browser.text(TIP), "");
}

fn walking_by_keys(browser: &mut Browser, study: &Study) {
    let runs = default_runs(study);
    browser.value("document.querySelector('#scene-0 .stage').focus()");
    for (key, index) in [
        ("ArrowRight", 0),
        ("ArrowRight", 1),
        ("End", 31),
        ("ArrowLeft", 30),
    ] {
        browser.key(key);
        check_words(&browser.text(TIP), runs[index]);
    }
    browser.key("ArrowDown");
    assert!(browser.text(TIP).starts_with("sppm ·"));
    browser.key("Escape");
    assert_eq!(browser.text(TIP), "");
}

fn hiding_a_curve(browser: &mut Browser) {
    let hidden =
        "getComputedStyle(document.querySelector('#scene-0 .wide .series[data-s=\"2\"]')).display";
    assert_eq!(browser.text(hidden), "inline");
    let at = browser.middle("#scene-0 .legend input[data-s=\"2\"]");
    browser.click(at);
    assert_eq!(browser.text(hidden), "none");
    browser.click(at);
    assert_eq!(browser.text(hidden), "inline");
}

const CLIP: &str = "getComputedStyle(document.querySelector('.viewer .right')).clipPath";

/// The share of the left picture.
fn clip(browser: &mut Browser) -> f64 {
    let text = browser.text(CLIP);
    let last = text
        .trim_end_matches(')')
        .rsplit(' ')
        .next()
        .unwrap()
        .to_owned();
    last.trim_end_matches('%')
        .parse()
        .unwrap_or_else(|_| panic!("{text}"))
}

fn sliding(browser: &mut Browser) {
    let [x, y] = browser.middle(".viewer .panes");
    assert_eq!(clip(browser), 50.0);
    browser.mouse("mouseMoved", [x, y]);
    browser.mouse("mousePressed", [x, y]);
    browser.mouse("mouseMoved", [x - 100.0, y]);
    browser.mouse("mouseReleased", [x - 100.0, y]);
    let width =
        browser.number("document.querySelector('.viewer .panes').getBoundingClientRect().width");
    let dragged = clip(browser);
    assert!(
        (dragged - (50.0 - 10000.0 / width)).abs() < 0.6,
        "{dragged}"
    );
    browser.mouse("mouseMoved", [x + 50.0, y]);
    assert_eq!(clip(browser), dragged, "let go means let go");
    browser.value("document.querySelector('.viewer input').focus()");
    browser.key("ArrowRight");
    assert!((clip(browser) - dragged - 0.5).abs() < 1e-9);
}

fn enlarging(browser: &mut Browser) {
    let view = "document.querySelector('.viewer .left').getAttribute('viewBox')";
    assert_eq!(browser.text(view), "0 0 120 80");
    let at = browser.middle(".viewer [data-zoom=in]");
    browser.click(at);
    assert_eq!(browser.text(view), "30 20 60 40");
    browser.value("document.querySelector('.viewer .panes').focus()");
    browser.key("ArrowLeft");
    assert_eq!(browser.text(view), "24 20 60 40");
    for _ in 0..9 {
        browser.key("ArrowUp");
    }
    assert_eq!(
        browser.text(view),
        "24 0 60 40",
        "it stays within the picture"
    );
    let at = browser.middle(".viewer [data-zoom=all]");
    browser.click(at);
    assert_eq!(browser.text(view), "0 0 120 80");
}

fn choosing_pictures(browser: &mut Browser) {
    let used = "document.querySelector('.viewer .left use').getAttribute('href')";
    let before = browser.text(used);
    let rows = "[...document.querySelectorAll('#scene-0 .strips')].map((s) => [...s.querySelectorAll('.row')].filter((r) => r.getClientRects().length).length)";
    assert_eq!(
        browser.value(rows),
        json!([1, 1]),
        "one level of each strip shows"
    );
    let at = browser.middle("#scene-0 .row:not([hidden]) figure:last-child .pick");
    browser.click(at);
    let after = browser.text(used);
    assert_ne!(before, after);
    let picked = "'#' + document.querySelector('#scene-0 .row:not([hidden]) figure:last-child .pick').dataset.pick";
    assert_eq!(after, browser.text(picked));
    let chosen = "[...document.querySelectorAll('#scene-0 .choice')].map((c) => c.querySelectorAll('[aria-pressed=true]').length)";
    assert_eq!(browser.value(chosen), json!([1, 1]));
}

const GROUND: &str = "getComputedStyle(document.body).backgroundColor";
const WHITE: &str = "rgb(255, 255, 255)";

fn colours(browser: &mut Browser) {
    assert_eq!(browser.text(GROUND), WHITE);
    browser.taste("dark", "");
    let dark = browser.text(GROUND);
    assert_ne!(dark, WHITE, "the system's taste counts");
    for (theme, ground) in [("light", WHITE), ("dark", &dark)] {
        let at = browser.middle(&format!(".theme [data-theme={theme}]"));
        browser.click(at);
        assert_eq!(browser.text(GROUND), ground);
    }
    browser.taste("light", "");
    assert_eq!(browser.text(GROUND), dark, "the reader's choice stays");
    browser.taste("light", "print");
    assert_eq!(browser.text(GROUND), WHITE, "paper is white");
    browser.taste("light", "");
    let at = browser.middle(".theme button");
    browser.click(at);
    assert_eq!(browser.text(GROUND), WHITE);
}

fn names_for_all_controls(browser: &mut Browser) {
    let tree = browser.call("Accessibility.getFullAXTree", &json!({}));
    let nodes = tree["nodes"].as_array().unwrap();
    let roles = [
        "button", "checkbox", "slider", "combobox", "link", "image", "img", "region",
    ];
    let mut count = 0;
    for node in nodes.iter().filter(|n| n["ignored"] != json!(true)) {
        if roles.contains(&node["role"]["value"].as_str().unwrap_or_default()) {
            let name = node["name"]["value"].as_str().unwrap_or_default();
            assert!(!name.trim().is_empty(), "without a name: {node}");
            count += 1;
        }
    }
    assert!(count > 50, "{count}");
}

fn phone(browser: &mut Browser, page: &Path, study: &Study) {
    browser.screen(320, 640, true);
    browser.open(page);
    assert_eq!(
        browser.number("document.documentElement.scrollWidth"),
        320.0
    );
    // Nothing reaches beyond the edge but what scrolls in a box of its own.
    let beyond = "[...document.querySelectorAll('body *')].filter((e) => !e.closest('.scroll, .panes, .store') \
                  && e.getBoundingClientRect().right > 320.5).map((e) => e.outerHTML.slice(0, 90))";
    assert_eq!(browser.value(beyond), json!([]));
    let shown = "[...document.querySelectorAll('#scene-0 .stage')][0].querySelector('.narrow').getClientRects().length";
    assert_eq!(browser.number(shown), 1.0);
    // A finger on the first dot, and one that moves the border.
    let at = browser.middle("#scene-0 .stage .narrow .dot");
    browser.touch("touchStart", Some(at));
    browser.touch("touchEnd", None);
    check_words(&browser.text(TIP), default_runs(study)[0]);
    let [x, y] = browser.middle(".viewer .panes");
    browser.touch("touchStart", Some([x, y]));
    for step in [10.0, 20.0, 40.0, 60.0] {
        browser.touch("touchMove", Some([x + step, y]));
    }
    browser.touch("touchEnd", None);
    let moved = clip(browser);
    assert!(moved > 60.0, "{moved}");
    assert_eq!(browser.complaints(), Vec::<Value>::new());
    browser.screen(1200, 900, false);
}

fn printing(browser: &mut Browser, page: &Path) {
    browser.open(page);
    browser.taste("dark", "print");
    let shown = |what: &str| {
        format!(
            "[...document.querySelectorAll('{what}')].filter((e) => e.getClientRects().length).length"
        )
    };
    assert_eq!(browser.number(&shown(".js")), 0.0);
    assert!(browser.number(&shown(".plot.wide")) > 3.0);
    assert_eq!(browser.number(&shown(".plot.narrow")), 0.0);
    browser.taste("light", "");
}

fn without_script(browser: &mut Browser, page: &Path) {
    let with = |off: bool| json!({ "value": off });
    browser.call("Emulation.setScriptExecutionDisabled", &with(true));
    browser.open(page);
    let shown = |what: &str| {
        format!(
            "[...document.querySelectorAll('{what}')].filter((e) => e.getClientRects().length).length"
        )
    };
    assert_eq!(
        browser.number(&shown(".js")),
        0.0,
        "what needs the script does not show"
    );
    assert_eq!(
        browser.number("document.querySelectorAll('#scene-0 .row').length"),
        browser.number(&shown("#scene-0 .row"))
    );
    let silent = "[...document.querySelectorAll('.dot')].filter((d) => !d.querySelector('title').textContent.includes('·')).length";
    assert_eq!(browser.number(silent), 0.0, "dots say what they are");
    browser.call("Emulation.setScriptExecutionDisabled", &with(false));
}

fn plots_are_well_formed(browser: &mut Browser, directory: &Path) {
    for file in std::fs::read_dir(directory.join("plots")).unwrap() {
        browser.open(&file.unwrap().path());
        let found = "document.documentElement.tagName + document.querySelectorAll('parsererror, script').length";
        assert_eq!(browser.text(found), "svg0");
        assert_eq!(browser.complaints(), Vec::<Value>::new());
    }
}

fn hostile_names(browser: &mut Browser) {
    let study = hostile();
    let directory = tempfile::tempdir().unwrap();
    report::write(&study, directory.path()).unwrap();
    browser.open(&directory.path().join("index.html"));
    assert_eq!(browser.complaints(), Vec::<Value>::new());
    assert_eq!(browser.value("window.harm === undefined"), json!(true));
    assert_eq!(browser.number("document.scripts.length"), 1.0);
    let text = browser.text("document.querySelector('#scene-0 h2').textContent");
    assert!(text.starts_with("<script>window.harm=1</script>"), "{text}");
    plots_are_well_formed(browser, directory.path());
}
