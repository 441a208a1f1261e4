//! `nephroid check`: reads a scene as `render` would and says what it found.

use std::path::Path;

use nephroid::{
    geometry::mesh::Edges,
    render::Job,
    scene::{Diagnostic, Diagnostics, MeshSummary, Place, Scene, Summary},
};
use serde_json::{Value, json};

use super::{Exit, Failure, args::CheckArgs, deliver, media::Media, progress, tell};

/// Checks the scene. The verdict goes to standard output; mistakes, unless
/// asked for as JSON, to standard error.
pub(super) fn run(typed: &CheckArgs) -> Result<Exit, Failure> {
    let name = typed.scene.display().to_string();
    let Some(scene) = scene_in_order(&typed.scene, typed.json, typed.json)? else {
        return Ok(Exit::BadInput);
    };
    Job::of(&scene).check().map_err(Failure::bad_input)?;
    let summary = Summary::of(&scene);
    let media = Media::of(&scene);
    for warning in &media.warnings {
        tell(format_args!("warning: {warning}"));
    }
    deliver(if typed.json {
        in_order(&name, &summary, &media, scene.settings.passes).to_string()
    } else {
        let mut lines = format!("{name} is in order\n{summary}");
        for place in &media.inside {
            lines += &format!("\nmedia      {place}");
        }
        lines
    })
    .map_err(Failure::fault)?;
    Ok(Exit::Done)
}

fn in_order(scene: &str, summary: &Summary, media: &Media, passes: u32) -> Value {
    json!({
        "scene": scene,
        "ok": true,
        "resolution": summary.resolution,
        "passes": passes,
        "objects": summary.objects,
        "casters": summary.casters,
        "triangles": summary.triangles,
        "meshes": summary.meshes.iter().map(mesh).collect::<Vec<_>>(),
        "lights": summary.light_count(),
        "media": media.inside,
        "warnings": media.warnings,
    })
}

fn mesh(found: &MeshSummary) -> Value {
    let edges = |edges: &Edges| {
        let first = edges.first.map(|ends| ends.map(|p| p.to_array()));
        json!({"count": edges.count, "first": first})
    };
    json!({
        "name": found.name,
        "places": found.places,
        "vertices": found.vertices,
        "triangles": found.triangles,
        "smooth": found.is_smooth,
        "closed": found.volume.is_some(),
        "volume": found.volume,
        "open_edges": edges(&found.defects.open),
        "twisted_edges": edges(&found.defects.twisted),
        "crowded_edges": edges(&found.defects.crowded),
        "doubled_faces": found.defects.doubled,
        "dropped_faces": found.dropped,
        "disagreeing_normals": found.disagreeing,
    })
}

/// The scene that a command looks at; `None` if it is not in order and standard
/// output has been told so as JSON.
pub(super) fn scene_in_order(
    path: &Path,
    quiet: bool,
    json: bool,
) -> Result<Option<Scene>, Failure> {
    match progress::load(path, quiet) {
        Ok(scene) => Ok(Some(scene)),
        Err(mistakes) if json => {
            let verdict = not_in_order(&path.display().to_string(), &mistakes);
            deliver(verdict).map_err(Failure::fault)?;
            Ok(None)
        }
        Err(mistakes) => Err(Failure::scene(&mistakes)),
    }
}

fn not_in_order(scene: &str, mistakes: &Diagnostics) -> Value {
    json!({
        "scene": scene,
        "ok": false,
        "count": mistakes.len(),
        "mistakes": mistakes.iter().map(mistake).collect::<Vec<_>>(),
    })
}

fn mistake(found: &Diagnostic) -> Value {
    let mut value = json!({
        "file": found.file,
        "message": found.message,
        "label": found.label,
        "help": found.help,
        "note": found.note,
    });
    match found.place {
        Place::File => {}
        Place::Text { line, column } => {
            value["line"] = line.into();
            value["column"] = column.into();
        }
        Place::Byte { offset } => value["byte"] = offset.into(),
    }
    value
}
