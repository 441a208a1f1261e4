//! What an effect brings and costs: the same passes with and without it.

use crate::{
    film::{Film, Layer},
    plan::{Plan, film_quantum},
    scene::Settings,
};

use super::{
    clock::Stopwatch,
    fault::Fault,
    record::Effect,
    request::{Event, Subject, Watch, Way},
    run::{Prepared, question},
    store::{Store, record_name},
};

/// Passes by which an effect is priced: a round.
const PASSES: u32 = 8;

/// The effects that the settings of the renderer can leave out: light between
/// diffuse surfaces, where there is some. The render without it stands for
/// what is left to do.
pub(super) fn effects(
    subject: &Subject<'_>,
    size: [u32; 2],
    store: &Store,
    watch: &mut Watch<'_>,
) -> Result<Vec<Effect>, Fault> {
    let settings = &subject.scene.settings;
    if !Plan::new(subject.scene, settings).indirect {
        return Ok(Vec::new());
    }
    let key = format!(
        "effect indirect; {PASSES} passes; {}",
        question(subject, Way::Photons, settings, size)
    );
    let name = record_name(&format!("{} effect indirect", subject.name), &key);
    if let Some((effect, _)) = store.read::<Effect>(&name, &key) {
        return Ok(vec![effect]);
    }
    let without = Settings {
        indirect: false,
        ..settings.clone()
    };
    let (with_seconds, film) = price(subject, settings, size, watch)?;
    let (without_seconds, _) = price(subject, &without, size, watch)?;
    let all = film.image().mean().mean();
    let effect = Effect {
        name: Layer::Indirect.name().to_owned(),
        light: if all > 0.0 {
            film.layer_image(Layer::Indirect).mean().mean() / all
        } else {
            0.0
        },
        with_seconds,
        without_seconds,
    };
    store.write(&name, &key, &effect, &[])?;
    Ok(vec![effect])
}

/// Processor time of a round, with what prepares it, and its film.
fn price(
    subject: &Subject<'_>,
    settings: &Settings,
    size: [u32; 2],
    watch: &mut Watch<'_>,
) -> Result<(f64, Film), Fault> {
    let mut clock = Stopwatch::default();
    let prepared = clock.time(|| Prepared::new(Way::Photons, subject.scene, settings, size))?;
    let mut passes = prepared.passes(0);
    let mut film = Film::new(size[0], size[1], film_quantum(subject.scene));
    for pass in 0..PASSES {
        clock.time(|| {
            if let Some(samples) = passes.next() {
                film.add_pass(pass, &samples);
            }
        });
        let flow = watch(&Event::Working {
            scene: subject.name.clone(),
            task: format!(
                "price of light between diffuse surfaces, {} it",
                if settings.indirect { "with" } else { "without" }
            ),
            passes: pass + 1,
            elapsed: clock.wall(),
            limit: None,
        });
        if flow.is_break() {
            return Err(Fault::Interrupted);
        }
    }
    Ok((clock.cpu_seconds(), film))
}
