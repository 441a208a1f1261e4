//! What an effect brings and costs: the same passes with and without it.

use serde::{Deserialize, Serialize};

use crate::{
    film::{Film, Image},
    metrics::relmse,
    plan::{film_quantum, judge},
    render::REPLICATES,
    scene::{self, Choice, Settings},
};

use super::{
    clock::Stopwatch,
    fault::Fault,
    record::Effect,
    request::{Event, Subject, Watch, Way},
    run::{Prepared, in_single, question},
    store::{Store, record_name},
    truth::Yardstick,
};

/// Passes by which an effect is priced: a round, one pass of each replicate.
const PASSES: u32 = REPLICATES;

/// The picture's name in a record.
const PICTURE: &str = "picture";

/// A round, and what it took.
struct Price {
    kept: Kept,
    picture: Image,
}

/// What is kept of it, beside its picture.
#[derive(Clone, Debug, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
struct Kept {
    cpu_seconds: f64,
    /// Mean of each replicate's picture over pixels and channels.
    means: [f64; REPLICATES as usize],
}

/// The effects that the scene calls for and that the settings can leave out.
/// Each is judged by the render without it, everything else being the same;
/// errors are there if the `truth` shows all light and is good enough.
pub(super) fn effects(
    subject: &Subject<'_>,
    size: [u32; 2],
    truth: Option<&Yardstick>,
    store: &Store,
    watch: &mut Watch<'_>,
) -> Result<Vec<Effect>, Fault> {
    let settings = &subject.scene.settings;
    let priced: Vec<scene::Effect> = judge(subject.scene, settings)
        .into_iter()
        .filter(|verdict| verdict.on && Choice::Off.suits(verdict.effect))
        .map(|verdict| verdict.effect)
        .collect();
    if priced.is_empty() {
        return Ok(Vec::new());
    }
    let work = Work {
        subject,
        size,
        store,
    };
    let with = work.price(settings, "with all effects", watch)?;
    let mut effects = Vec::new();
    for effect in priced {
        let mut less = settings.clone();
        less.effects.set(effect, Choice::Off);
        let words = format!("without {}", effect.name());
        let without = work.price(&less, &words, watch)?;
        let (light, light_error) = missing(&with.kept.means, &without.kept.means);
        let error = |price: &Price| truth.and_then(|truth| error(&price.picture, truth));
        effects.push(Effect {
            name: effect.name().to_owned(),
            title: effect.title().to_owned(),
            light,
            light_error,
            with_seconds: with.kept.cpu_seconds,
            without_seconds: without.kept.cpu_seconds,
            with_error: error(&with),
            without_error: error(&without),
        });
    }
    Ok(effects)
}

/// The part of the light that is missing without an effect, and the standard
/// error of that ratio, from the replicates: each has the same samples with the
/// effect and without (W. Cochran, *Sampling Techniques*, section 6.4).
fn missing(with: &[f64], without: &[f64]) -> (f64, f64) {
    let n = with.len() as f64;
    let all = with.iter().sum::<f64>() / n;
    if all <= 0.0 {
        return (0.0, 0.0);
    }
    let kept = without.iter().sum::<f64>() / n / all;
    let off = with.iter().zip(without).map(|(w, o)| o - kept * w);
    let squares: f64 = off.map(|d| d * d).sum();
    (1.0 - kept, libm::sqrt(squares / (n * (n - 1.0))) / all)
}

/// The error of a picture, freed of the truth's own, if the truth can judge it.
fn error(picture: &Image, truth: &Yardstick) -> Option<f64> {
    let relmse = relmse(picture, &truth.picture).ok()?;
    let is_judged = truth.can_judge(relmse);
    is_judged.then(|| libm::sqrt(relmse - truth.variance))
}

/// What all prices of a scene have in common.
struct Work<'a> {
    subject: &'a Subject<'a>,
    size: [u32; 2],
    store: &'a Store,
}

impl Work<'_> {
    /// A round with these settings: one that was kept, or one made now.
    fn price(
        &self,
        settings: &Settings,
        words: &str,
        watch: &mut Watch<'_>,
    ) -> Result<Price, Fault> {
        let question = question(self.subject, Way::Photons, settings, self.size);
        let key = format!("price; {PASSES} passes; {question}");
        let name = record_name(&format!("{} price {words}", self.subject.name), &key);
        if let Some((kept, mut pictures)) = self.store.read::<Kept>(&name, &key)
            && let Some((_, picture)) = pictures.pop()
        {
            return Ok(Price { kept, picture });
        }
        let price = self.render(settings, words, watch)?;
        let named = [(PICTURE, &price.picture)];
        self.store.write(&name, &key, &price.kept, &named)?;
        Ok(price)
    }

    /// Processor time of a round, with what prepares it, and its picture as it
    /// is kept.
    fn render(
        &self,
        settings: &Settings,
        words: &str,
        watch: &mut Watch<'_>,
    ) -> Result<Price, Fault> {
        let scene = self.subject.scene;
        let mut clock = Stopwatch::default();
        let prepared = clock.time(|| Prepared::new(Way::Photons, scene, settings, self.size))?;
        let mut passes = prepared.passes(0);
        let mut film = Film::new(self.size[0], self.size[1], film_quantum(scene));
        for pass in 0..PASSES {
            clock.time(|| {
                if let Some(samples) = passes.next() {
                    film.add_pass(pass, &samples);
                }
            });
            let flow = watch(&Event::Working {
                scene: self.subject.name.clone(),
                task: format!("price of effects, {words}"),
                passes: pass + 1,
                elapsed: clock.wall(),
                limit: None,
            });
            if flow.is_break() {
                return Err(Fault::Interrupted);
            }
        }
        let kept = Kept {
            cpu_seconds: clock.cpu_seconds(),
            means: std::array::from_fn(|r| film.replicate_image(r).mean().mean()),
        };
        let picture = in_single(&film.image());
        Ok(Price { kept, picture })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_missing() {
        let (light, error) = missing(&[4.0, 4.0, 4.0, 4.0], &[3.0, 3.0, 3.0, 3.0]);
        assert_eq!((light, error), (0.25, 0.0));
        // A half of 2 on average, and 1/8 either side of it in two.
        let (light, error) = missing(&[2.0, 2.0], &[1.25, 0.75]);
        assert!((light - 0.5).abs() < 1e-15 && (error - 0.125).abs() < 1e-15);
        // A share is sure if it is the same in all, however much light there is.
        assert_eq!(missing(&[1.0, 7.0, 2.0], &[0.5, 3.5, 1.0]), (0.5, 0.0));
        assert_eq!(missing(&[0.0; 8], &[0.0; 8]), (0.0, 0.0));
    }
}
