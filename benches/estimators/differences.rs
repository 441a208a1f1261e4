//! A scene without a known truth: how its pictures of two seeds come nearer to each
//! other, and what each says of its own error.

use std::path::Path;

use nephroid::{
    film::Film,
    metrics::{Statement, relmse_trimmed},
    plan::film_quantum,
    render::{Job, REPLICATES, Renderer},
    scene::{Scene, load},
};

use crate::{
    clock::Clock,
    cost::{Row, Series},
    table::{say, slopes},
};

/// Part of the pixels that are left out: the worst.
const WORST: f64 = 0.001;

/// One seed's picture as it grows.
struct Growing<'a> {
    renderer: Renderer<'a>,
    film: Film,
    passes: u32,
}

impl<'a> Growing<'a> {
    fn new(scene: &'a Scene, seed: u64) -> Self {
        let mut settings = scene.settings.clone();
        settings.seed = seed;
        let size @ [width, height] = Job::of(scene).resolution;
        Self {
            renderer: Renderer::new(scene, &settings, size, [0, 0, width, height]),
            film: Film::new(width, height, film_quantum(scene)),
            passes: 0,
        }
    }

    fn until(&mut self, passes: u32) {
        for pass in self.passes..passes {
            self.film.add_pass(pass, &self.renderer.pass(pass).samples);
        }
        self.passes = passes;
    }
}

/// Lets pictures of two seeds grow until the next doubling of the passes would take
/// one of them longer than `seconds` of processor time, and prints the relMSE by
/// their difference, which is noise alone, and what the first states of itself.
pub(crate) fn differences(path: &str, seconds: f64) {
    let scene = load(Path::new(path)).unwrap_or_else(|e| panic!("{e}"));
    say(&format!("\n{path}: relMSE without the worst 0.1 %"));
    say("passes     CPU s   two seeds  stated noise  stated bias  stated");
    let clock = Clock::start();
    let mut pictures = [1, 2].map(|seed| Growing::new(&scene, seed));
    let [mut apart, mut stated] = [Vec::new(), Vec::new()];
    let rounds = std::iter::successors(Some(REPLICATES), |passes| Some(2 * passes));
    for passes in rounds {
        for picture in &mut pictures {
            picture.until(passes);
        }
        let spent = clock.seconds() / 2.0;
        let error = by_difference(&pictures[0].film, &pictures[1].film);
        let Some(whole) = Statement::of(&pictures[0].film, None).map(|s| s.whole) else {
            return say("black");
        };
        let [own, noise, bias] = [whole.error, whole.noise, whole.bias].map(|e| e * e);
        say(&format!(
            "{passes:6}  {spent:8.2}   {error:9.2e}     {noise:9.2e}    {bias:9.2e}  {own:9.2e}"
        ));
        let row = |error| Row {
            photons: u64::from(passes),
            seconds: spent,
            error,
        };
        apart.push(row(error));
        stated.push(row(own));
        if 2.0 * spent > seconds {
            break;
        }
    }
    // One row stands for so many passes, not photons.
    for (name, rows) in [("two seeds", apart), ("stated", stated)] {
        slopes(&Series::new(name.to_owned(), rows), "passes");
    }
}

/// relMSE of one of two pictures, if they differ by noise alone.
fn by_difference(a: &Film, b: &Film) -> f64 {
    let mut mean = a.clone();
    mean.merge(b).expect("of one scene");
    // Half the difference from the mean: half the variance of one.
    2.0 * relmse_trimmed(&a.image(), &mean.image(), WORST).expect("of one size")
}
