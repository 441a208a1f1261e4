//! `nephroid merge`: the picture that parts of it make together.

use std::path::Path;

use nephroid::render::Part;

use super::{
    Exit, Failure,
    args::MergeArgs,
    outputs::{self, Json, Told},
    parts::Merged,
    values::Output,
};

/// Reads the parts, sums them, writes the files.
pub(super) fn run(typed: &MergeArgs) -> Result<Exit, Failure> {
    let json = typed.json.as_deref().map(Json::of);
    let mut pictures: Vec<Output> = Vec::new();
    let mut parts: Vec<&Path> = Vec::new();
    for product in &typed.output {
        match product {
            Merged::Picture(output) => pictures.push(output.clone()),
            Merged::Part(path) => parts.push(path),
        }
    }
    outputs::probe(&pictures, json.as_ref(), &parts)?;
    let mut whole: Option<Part> = None;
    for path in &typed.parts {
        let name = path.display();
        let part = Part::load(path).map_err(|e| Failure::bad_input(format!("{name}: {e}")))?;
        match &mut whole {
            None => whole = Some(part),
            Some(whole) => whole.merge(&part).map_err(|e| {
                let first = typed.parts[0].display();
                let more = if typed.parts.len() > 2 {
                    " and those after it"
                } else {
                    ""
                };
                Failure::bad_input(format!("{name} cannot be merged with {first}{more}: {e}"))
            })?,
        }
    }
    let whole = whole.ok_or_else(|| Failure::bad_input("there is no part to merge"))?;
    refuse_gaps(&whole)?;
    let told = Told::of(&whole, None, None);
    let mut faults = outputs::save(&whole, &told, &pictures, json.as_ref());
    for path in &parts {
        faults.extend(whole.save(path).err().map(|e| e.to_string()));
    }
    if !faults.is_empty() {
        return Err(Failure::fault(faults.join("\nerror: ")));
    }
    if !typed.quiet {
        let pictures = pictures.iter().map(|o| o.path.as_path());
        told.say(pictures.chain(parts));
    }
    Ok(Exit::Done)
}

/// A picture without some passes in its middle is the picture of no render.
fn refuse_gaps(whole: &Part) -> Result<(), Failure> {
    let runs = whole.runs();
    let gaps: Vec<String> = runs
        .windows(2)
        .map(|pair| format!("{}..{}", pair[0].end, pair[1].start))
        .collect();
    if gaps.is_empty() {
        return Ok(());
    }
    let passes = gaps.join(" and ");
    let flag = &gaps[0];
    Err(Failure::bad_input(format!(
        "the passes {passes} are missing between the parts; render them, too: \
         --passes {flag} --checkpoint missing.ckpt"
    )))
}
