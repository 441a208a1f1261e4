//! Broken scenes and what is said about them.
//!
//! Every scene in `tests/broken` starts with lines
//! `// expect PLACE | MESSAGE | REMEDY`: the place of a mistake (line and
//! column in the scene itself, or a mesh file with line and column, byte or
//! nothing), a part of the message and a part of the remedy. Exactly these
//! mistakes must be reported, in this order.

use std::{
    fmt::Write,
    fs,
    path::{Path, PathBuf},
};

use nephroid::scene::{Diagnostic, Diagnostics, Place, load, load_str};

struct Expectation {
    place: String,
    message: String,
    help: String,
}

fn corpus() -> Vec<PathBuf> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/broken");
    let files = fs::read_dir(folder)
        .expect("the corpus")
        .map(|entry| entry.expect("a file").path());
    let mut scenes: Vec<PathBuf> = files
        .filter(|path| path.extension().is_some_and(|e| e == "ron"))
        .collect();
    scenes.sort();
    scenes
}

fn expectations(text: &str) -> Vec<Expectation> {
    let lines = text
        .lines()
        .map_while(|line| line.strip_prefix("// expect "));
    lines
        .map(|line| {
            let parts: Vec<&str> = line.split(" | ").map(str::trim).collect();
            let [place, message, help] = parts.as_slice() else {
                panic!("{line:?} has not three parts");
            };
            Expectation {
                place: (*place).to_owned(),
                message: (*message).to_owned(),
                help: (*help).to_owned(),
            }
        })
        .collect()
}

/// What differs between a mistake and what was expected of it.
fn difference(scene: &Path, wanted: &Expectation, found: &Diagnostic) -> Option<String> {
    let folder = scene.parent().expect("a folder").join("");
    let in_scene = wanted.place.starts_with(|c: char| c.is_ascii_digit());
    let place = if in_scene {
        format!("{}:{}", scene.display(), wanted.place)
    } else {
        format!("{}{}", folder.display(), wanted.place)
    };
    if found.location() != place {
        return Some(format!(
            "expected at {place}, found at {}",
            found.location()
        ));
    }
    let rendered = found.render(false);
    if !found.message.contains(&wanted.message) {
        return Some(format!("expected the message {:?}", wanted.message));
    }
    if !found
        .help
        .as_deref()
        .unwrap_or_default()
        .contains(&wanted.help)
    {
        return Some(format!("expected the remedy {:?}", wanted.help));
    }
    if let Place::Text { line, column } = found.place {
        let at = format!("{}:{line}:{column}\n", found.file);
        if !rendered.contains(&at) {
            return Some(format!("the rendered text lacks {at:?}"));
        }
        if !rendered.contains('^') {
            return Some("the rendered text marks nothing".to_owned());
        }
    }
    None
}

fn errors_of(scene: &Path) -> Diagnostics {
    match load(scene) {
        Ok(_) => panic!("{} was accepted", scene.display()),
        Err(diagnostics) => diagnostics,
    }
}

#[test]
fn every_broken_scene_is_explained_where_it_is_broken() {
    let scenes = corpus();
    assert!(
        scenes.len() >= 60,
        "the corpus has only {} scenes",
        scenes.len()
    );
    let mut failures = String::new();
    for scene in scenes {
        let wanted = expectations(&fs::read_to_string(&scene).expect("a scene"));
        assert!(!wanted.is_empty(), "{} expects nothing", scene.display());
        let found = errors_of(&scene);
        let mut complaints: Vec<String> = wanted
            .iter()
            .zip(&found)
            .filter_map(|(w, f)| difference(&scene, w, f))
            .collect();
        if wanted.len() != found.len() {
            complaints.push(format!(
                "expected {} mistakes, found {}",
                wanted.len(),
                found.len()
            ));
        }
        if !complaints.is_empty() {
            let name = scene.file_name().expect("a name").display();
            let _ = writeln!(failures, "== {name}: {}\n{found}", complaints.join("; "));
        }
    }
    assert!(failures.is_empty(), "\n{failures}");
}

#[test]
fn files_that_are_no_scenes_are_refused() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = |name: &str| folder.path().join(name);
    fs::write(path("empty.ron"), "").expect("written");
    fs::write(path("comment.ron"), "// nothing\n\n").expect("written");
    fs::write(path("binary.ron"), b"(camera: \xff\xfe)").expect("written");
    for (name, message) in [
        ("missing.ron", "no such scene file"),
        ("", "directory"),
        ("empty.ron", "empty"),
        ("comment.ron", "empty"),
        ("binary.ron", "UTF-8"),
    ] {
        let found = errors_of(&path(name));
        let first = found.iter().next().expect("a mistake");
        assert!(first.message.contains(message), "{name}: {found}");
        assert!(found.to_string().contains(&first.file), "{name}: {found}");
    }
}

#[test]
fn places_hold_behind_tabs_and_wide_characters() {
    let text = "(\n\t/* größe 光 */ camera: 3,\n)";
    let found = load_str(text, "x.ron", Path::new("")).expect_err("broken");
    let camera = found
        .iter()
        .find(|d| d.message.contains("wrong type"))
        .expect("a mistake");
    assert_eq!(
        camera.place,
        Place::Text {
            line: 2,
            column: 24
        }
    );
    assert!(
        camera.render(false).contains("x.ron:2:24\n"),
        "{}",
        camera.render(false)
    );
}

#[test]
fn thousands_of_mistakes_are_cut_short() {
    let mut text = String::from("(objects: [");
    text.push_str(&"(shpe: 3),\n".repeat(5000));
    text.push_str("])");
    let found = load_str(&text, "x.ron", Path::new("")).expect_err("broken");
    assert!((200..210).contains(&found.len()), "{}", found.len());
    let shown = found.to_string();
    assert!(
        shown.contains("and at least 18"),
        "{}",
        &shown[shown.len() - 200..]
    );
    assert!(shown.lines().count() < 300);
}
