//! `nephroid plan`: what a scene calls for, and why the rest is not there.

use nephroid::{
    render::Job,
    survey::{EffectReport, Funnel, Survey, percent},
};
use serde_json::json;

use super::{
    Exit, Failure, args::PlanArgs, check, deliver, effects::EffectChoice, media::Media, tell,
};

/// Surveys the scene and prints what was found, on standard output.
pub(super) fn run(typed: &PlanArgs) -> Result<Exit, Failure> {
    let name = typed.scene.display().to_string();
    let Some(scene) = check::scene_in_order(&typed.scene, typed.json, typed.json)? else {
        return Ok(Exit::BadInput);
    };
    let mut job = Job::of(&scene);
    job.resolution = typed.resolution.unwrap_or(scene.resolution);
    job.settings.seed = typed.seed.unwrap_or(job.settings.seed);
    EffectChoice::apply(&typed.effects, &mut job.settings);
    job.check().map_err(Failure::bad_input)?;
    for warning in Media::of(&scene).warnings {
        tell(format_args!("warning: {warning}"));
    }
    let survey = Survey::of(&scene, &job.settings, job.resolution);
    deliver(if typed.json {
        let mut value = json!(survey);
        value["scene"] = name.into();
        value["ok"] = true.into();
        value.to_string()
    } else {
        words(&name, &survey)
    })
    .map_err(Failure::fault)?;
    Ok(Exit::Done)
}

/// The plan for people.
fn words(name: &str, survey: &Survey) -> String {
    let [w, h] = survey.resolution;
    let mut text = format!("{name}, {w} x {h} pixels\n\n");
    let rows = survey.effects.iter().map(effect_row);
    let head = ["effect", "", "light", "work", "why"].map(str::to_owned);
    text += &table([head].into_iter().chain(rows));
    text += &format!(
        "The ways from the eye take the other {} of the work.",
        percent(survey.view_work)
    );
    if survey
        .effects
        .iter()
        .any(|e| e.seen_through.is_some_and(|m| m.share > 0.0))
    {
        text += "\n(In brackets: the part of the light that the eye sees by way of it.)";
    }
    for effect in survey
        .effects
        .iter()
        .filter(|e| e.on && e.without != "nothing")
    {
        if effect.light.is_some_and(|m| m.share > 0.0)
            || effect.effect == nephroid::scene::Effect::Glints
        {
            text += &format!("\nWithout {}: {}.", effect.effect.title(), effect.without);
        }
    }
    text += "\n\n";
    if survey.funnels.is_empty() {
        text += "No light shines on anything that reflects or bends it: no photons.\n";
    } else {
        let head = ["photons of", "to", "aimed", "met", "landed", "seen", ""].map(str::to_owned);
        text += &table(
            [head]
                .into_iter()
                .chain(survey.funnels.iter().map(funnel_row)),
        );
        if survey.more_funnels > 0 {
            text += &format!(
                "and {} more pairs of light and object\n",
                survey.more_funnels
            );
        }
    }
    text += "\n";
    if survey.left_out.is_empty() {
        text += "left out: nothing";
    } else {
        let all = percent(survey.share_left_out());
        text += &format!("left out: about {all} of the light");
        for omission in &survey.left_out {
            text += &format!("\n  {}: {}", omission.what, percent(omission.light));
        }
    }
    text
}

fn effect_row(effect: &EffectReport) -> [String; 5] {
    let share = match (effect.light, effect.seen_through) {
        (Some(m), _) if m.share > 0.0 => percent(m.share),
        (_, Some(m)) if m.share > 0.0 => format!("({})", percent(m.share)),
        _ => "-".to_owned(),
    };
    [
        effect.effect.title().to_owned(),
        if effect.on { "on" } else { "off" }.to_owned(),
        share,
        match effect.work {
            Some(work) if work > 0.0 => percent(work),
            _ => "-".to_owned(),
        },
        match (effect.by_user, effect.on) {
            (false, _) => effect.why.clone(),
            (true, true) => format!("forced on; {}", effect.why),
            (true, false) => format!("switched off; {}", effect.why),
        },
    ]
}

fn funnel_row(funnel: &Funnel) -> [String; 7] {
    [
        funnel.light.clone(),
        funnel.object.clone(),
        funnel.aimed.to_string(),
        funnel.met.to_string(),
        funnel.landed.to_string(),
        funnel.seen.to_string(),
        funnel
            .reason
            .as_ref()
            .map_or_else(String::new, |why| format!("no caustic: {why}")),
    ]
}

/// Lines with columns that are as wide as their widest entry; those between
/// the first two and the last are numbers and stand on the right.
fn table<const N: usize>(rows: impl Iterator<Item = [String; N]>) -> String {
    let rows: Vec<[String; N]> = rows.collect();
    let width = |k: usize| rows.iter().map(|r| r[k].chars().count()).max().unwrap_or(0);
    let widths: [usize; N] = std::array::from_fn(width);
    let mut text = String::new();
    for row in &rows {
        let mut line = String::new();
        for (k, (cell, width)) in row.iter().zip(widths).enumerate() {
            line += &match k {
                _ if k + 1 == N => cell.clone(),
                0 | 1 => format!("{cell:width$}  "),
                _ => format!("{cell:>width$}  "),
            };
        }
        text += line.trim_end();
        text += "\n";
    }
    text
}
