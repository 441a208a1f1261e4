//! Reading a scene: text, outline, description, scene.
//!
//! Every section, list element and map entry is read on its own, so that
//! independent mistakes are found together; what could be read is then
//! checked for its meaning, too, whatever else was wrong.

use std::{fs::File, io::Read, path::Path};

use super::{
    Scene, build,
    decode::{options, suggest},
    description::{
        Description, MaterialChoice, MeshSource, ObjectDescription, Part, PartMaterials,
    },
    diagnostics::{Diagnostic, Diagnostics},
    mesh_file::Watch,
    outline::{Kind, NodeId, Outline},
    report::Report,
    source::Source,
};

/// Largest scene file, in bytes.
pub const MAX_SCENE_BYTES: u64 = 64 << 20;

/// Reads a scene file and builds the scene. Paths of meshes are relative to
/// the file's directory.
///
/// # Errors
/// Every mistake found in the file and the files it names.
pub fn load(path: &Path) -> Result<Scene, Diagnostics> {
    load_watched(path, &|_| {})
}

/// [`load`], telling `watch` how far it is.
///
/// # Errors
/// Every mistake found in the file and the files it names.
pub fn load_watched(path: &Path, watch: Watch) -> Result<Scene, Diagnostics> {
    let name = path.display().to_string();
    let text = read_text(path).map_err(|message| Diagnostic::of_file(&name, message))?;
    let base = path.parent().unwrap_or(Path::new(""));
    from_text(&text, &name, base, watch)
}

/// Builds a scene from text. `file_name` appears in messages; paths of meshes
/// are relative to `base_dir`.
///
/// # Errors
/// Every mistake found in the text and the files it names.
pub fn load_str(text: &str, file_name: &str, base_dir: &Path) -> Result<Scene, Diagnostics> {
    from_text(text, file_name, base_dir, &|_| {})
}

fn from_text(
    text: &str,
    file_name: &str,
    base_dir: &Path,
    watch: Watch,
) -> Result<Scene, Diagnostics> {
    if text.len() as u64 > MAX_SCENE_BYTES {
        return Err(Diagnostic::of_file(file_name, too_large()).into());
    }
    let source = Source::new(file_name, text);
    let outline = Outline::scan(source.text()).map_err(|e| {
        let mut diagnostic = Diagnostic::in_text(&source, e.span, e.message).with_label(e.label);
        if !e.help.is_empty() {
            diagnostic = diagnostic.with_help(e.help);
        }
        Diagnostics::from(diagnostic)
    })?;
    let mut report = Report::new(source, outline);
    let description = read_description(&mut report);
    let scene = build::build(&description, base_dir, watch, &mut report);
    let mut diagnostics = report.diagnostics;
    match scene {
        Some(scene) if diagnostics.is_empty() => Ok(scene),
        _ => {
            diagnostics.sort(file_name);
            Err(diagnostics)
        }
    }
}

fn too_large() -> String {
    format!(
        "the scene file is larger than {} MiB; put meshes into files of their own",
        MAX_SCENE_BYTES >> 20
    )
}

/// The text of a regular file of bounded size.
fn read_text(path: &Path) -> Result<String, String> {
    let unreadable = |e: std::io::Error| match e.kind() {
        std::io::ErrorKind::NotFound => "there is no such scene file".to_owned(),
        _ => format!("cannot read the scene file: {e}"),
    };
    let metadata = std::fs::metadata(path).map_err(unreadable)?;
    if metadata.is_dir() {
        return Err("this is a directory, not a scene file".to_owned());
    }
    if !metadata.is_file() {
        return Err("this is not a regular file".to_owned());
    }
    let mut bytes = Vec::new();
    let file = File::open(path).map_err(unreadable)?;
    file.take(MAX_SCENE_BYTES + 1)
        .read_to_end(&mut bytes)
        .map_err(unreadable)?;
    if bytes.len() as u64 > MAX_SCENE_BYTES {
        return Err(too_large());
    }
    String::from_utf8(bytes).map_err(|e| {
        let at = e.utf8_error().valid_up_to();
        format!("the scene file is not UTF-8 text (byte {at}); is it a scene file?")
    })
}

const SECTIONS: [&str; 7] = [
    "camera",
    "image",
    "materials",
    "meshes",
    "objects",
    "lights",
    "render",
];

/// Reads all parts of a scene; what cannot be read is reported.
fn read_description(report: &mut Report) -> Description {
    check_extensions(report);
    let root = report.outline.root();
    let mut description = Description::default();
    if !matches!(report.outline.kind(root), Kind::Struct) {
        let is_empty = report.outline.kind(root) == Kind::Tuple
            && report.outline.children(root).next().is_none();
        if !is_empty {
            let found = report.outline.kind(root).words();
            let message = format!("a scene is a list of named sections, found {found}");
            let label = "expected `(camera: .., image: .., objects: [..], lights: [..])`";
            report.push(report.about_head(root, message).with_label(label));
            return description;
        }
    }
    check_root_name(report, root);
    let [camera, image, materials, meshes, objects, lights, render] =
        fields(report, root, SECTIONS, &["camera", "image"]);
    description.camera = camera.and_then(|node| part(report, node));
    description.image = image.and_then(|node| part(report, node));
    description.render = render.and_then(|node| part(report, node));
    for (name, node) in entries(report, materials) {
        if report.diagnostics.is_full() {
            break;
        }
        let value = report.decode(node);
        description.materials.push((name, Part { node, value }));
    }
    for (name, node) in entries(report, meshes) {
        if report.diagnostics.is_full() {
            break;
        }
        let value = read_mesh_source(report, node);
        description.meshes.push((name, Part { node, value }));
    }
    for node in elements(report, objects) {
        if report.diagnostics.is_full() {
            break;
        }
        let value = read_object(report, node);
        description.objects.push(Part { node, value });
    }
    for node in elements(report, lights) {
        if report.diagnostics.is_full() {
            break;
        }
        let value = report.decode(node);
        description.lights.push(Part { node, value });
    }
    description
}

fn check_extensions(report: &mut Report) {
    const KNOWN: [&str; 4] = [
        "implicit_some",
        "unwrap_newtypes",
        "unwrap_variant_newtypes",
        "explicit_struct_names",
    ];
    for span in report.outline.extensions().to_vec() {
        let name = report.text()[span.clone()].to_owned();
        if !KNOWN.contains(&name.as_str()) {
            let diagnostic =
                Diagnostic::in_text(&report.source, span, format!("unknown extension `{name}`"))
                    .with_label("scene files need no extensions");
            report.push(suggest(diagnostic, &name, &KNOWN));
        }
    }
}

fn check_root_name(report: &mut Report, root: NodeId) {
    let Some(name) = report.outline.name(root) else {
        return;
    };
    if &report.text()[name] != "Scene" {
        let diagnostic = report
            .about_head(root, "a scene starts with `(` or `Scene(`")
            .with_label("expected `Scene` or nothing");
        report.push(diagnostic);
    }
}

/// The values of known fields; unknown, repeated and missing ones are
/// reported.
fn fields<const N: usize>(
    report: &mut Report,
    node: NodeId,
    known: [&str; N],
    required: &[&str],
) -> [Option<NodeId>; N] {
    let mut found = [None; N];
    let children: Vec<NodeId> = report.outline.children(node).collect();
    for child in children {
        if report.diagnostics.is_full() {
            break;
        }
        let key = report.outline.key_text(report.text(), child);
        match known.iter().position(|&k| Some(k) == key) {
            None => report.push(report.unknown_field(child, &known)),
            Some(i) if found[i].is_some() => {
                let diagnostic = report
                    .about_key(child, format!("`{}` is given twice", known[i]))
                    .with_label("given before")
                    .with_help("remove one of the two");
                report.push(diagnostic);
            }
            Some(i) => found[i] = Some(child),
        }
    }
    for (i, name) in known.iter().enumerate() {
        if found[i].is_none() && required.contains(name) {
            report.push(report.missing_field(node, name));
        }
    }
    found
}

fn part<T: serde::de::DeserializeOwned>(report: &mut Report, node: NodeId) -> Option<Part<T>> {
    report.decode(node).map(|value| Part { node, value })
}

/// The entries of a map with texts as keys.
fn entries(report: &mut Report, map: Option<NodeId>) -> Vec<(String, NodeId)> {
    let Some(map) = map else {
        return vec![];
    };
    if report.outline.kind(map) != Kind::Map {
        let found = report.outline.kind(map).words();
        report.push(report.wrong_value(map, format!("expected a map, found {found}")));
        return vec![];
    }
    let children: Vec<NodeId> = report.outline.children(map).collect();
    let mut list: Vec<(String, NodeId)> = Vec::with_capacity(children.len());
    let mut seen = std::collections::HashSet::new();
    for child in children {
        if report.diagnostics.is_full() {
            break;
        }
        let raw = &report.text()[report.outline.key(child).unwrap_or_default()];
        let Ok(name) = options().from_str::<String>(raw) else {
            let diagnostic = report
                .about_key(child, "a name is a text in double quotes")
                .with_label("expected `\"name\"`")
                .with_help(format!("write `\"{}\"`", super::decode::short(raw)));
            report.push(diagnostic);
            continue;
        };
        if !seen.insert(name.clone()) {
            let message = format!(
                "the name \"{}\" is given twice",
                super::decode::short(&name)
            );
            let diagnostic = report
                .about_key(child, message)
                .with_label("given before")
                .with_help("rename one of the two");
            report.push(diagnostic);
        }
        list.push((name, child));
    }
    list
}

fn elements(report: &mut Report, list: Option<NodeId>) -> Vec<NodeId> {
    let Some(list) = list else {
        return vec![];
    };
    if report.outline.kind(list) != Kind::List {
        let found = report.outline.kind(list).words();
        report.push(report.wrong_value(list, format!("expected a list, found {found}")));
        return vec![];
    }
    report.outline.children(list).collect()
}

/// A mesh source; bare fields mean `Mesh(..)`.
fn read_mesh_source(report: &mut Report, node: NodeId) -> Option<MeshSource> {
    let is_bare = report.outline.name(node).is_none()
        && matches!(report.outline.kind(node), Kind::Struct | Kind::Tuple);
    if is_bare {
        return report.decode(node).map(MeshSource::Mesh);
    }
    report.decode(node)
}

fn read_object(report: &mut Report, node: NodeId) -> ObjectDescription {
    let mut object = ObjectDescription {
        name: None,
        shape: None,
        material: None,
        materials: None,
        at: None,
        open: false,
    };
    if report.outline.kind(node) != Kind::Struct || report.outline.name(node).is_some() {
        let diagnostic = report
            .about_head(
                node,
                "an object is a group of fields without a name in front",
            )
            .with_label("expected `(shape: .., material: ..)`");
        report.push(diagnostic);
        return object;
    }
    let known = ["name", "shape", "material", "materials", "at", "open"];
    let has_parts = report.outline.field(report.text(), node, "materials");
    let required: &[&str] = match has_parts {
        Some(_) => &["shape"],
        None => &["shape", "material"],
    };
    let [name, shape, material, materials, at, open] = fields(report, node, known, required);
    object.name = name.and_then(|n| report.decode(n));
    object.shape = shape.and_then(|n| part(report, n));
    object.material = material.and_then(|n| read_material(report, n));
    object.materials = materials.map(|n| read_part_materials(report, n));
    object.at = at.map(|n| read_placement(report, n));
    object.open = open.and_then(|n| report.decode(n)).unwrap_or(false);
    object
}

fn read_material(report: &mut Report, node: NodeId) -> Option<Part<MaterialChoice>> {
    let value = if report.outline.kind(node) == Kind::Text {
        MaterialChoice::Named(report.decode(node)?)
    } else {
        MaterialChoice::Inline(report.decode(node)?)
    };
    Some(Part { node, value })
}

/// The materials of a mesh's parts, by name.
fn read_part_materials(report: &mut Report, node: NodeId) -> PartMaterials {
    let mut value = Vec::new();
    for (name, node) in entries(report, Some(node)) {
        let choice = read_material(report, node).map(|part| part.value);
        value.push((
            name,
            Part {
                node,
                value: choice,
            },
        ));
    }
    Part { node, value }
}

/// The steps of `at`: one, or a list.
fn read_placement(
    report: &mut Report,
    node: NodeId,
) -> Part<Vec<Part<super::description::TransformStep>>> {
    let steps = if report.outline.kind(node) == Kind::List {
        report.outline.children(node).collect()
    } else {
        vec![node]
    };
    let value = steps
        .into_iter()
        .filter_map(|step| part(report, step))
        .collect();
    Part { node, value }
}
