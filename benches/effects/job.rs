//! What a process of its own does: some passes of a scene.

use std::{
    env, fmt,
    path::Path,
    process::{Command, Output},
};

use nephroid::{
    film::Image,
    render::Renderer,
    scene::{Choice, Effect, Settings},
    spectrum::Rgb,
};

use crate::{clock::Clock, scenes};

/// What a child process is asked by.
const JOB: &str = "NEPHROID_EFFECTS_BENCH";

/// Picture and photon paths of a pass.
pub(crate) const SIZE: [u32; 2] = [64, 48];
const PHOTONS: u64 = 4096;

/// Passes of the shorter and the longer process: the rounds of both have the
/// same pilots.
pub(crate) const PASSES: [u32; 2] = [1, 5];

/// Times that a process is timed where instructions cannot be counted.
const TRIES: u32 = 5;

/// Passes of a scene with something said about an effect.
#[derive(Clone)]
pub(crate) struct Job {
    scene: String,
    said: Option<(Effect, Said)>,
    passes: u32,
}

/// What is said about an effect.
#[derive(Clone, Copy, PartialEq)]
pub(crate) enum Said {
    /// It is worked out, in vain or not.
    On,
    /// The scene has nothing of it: see [`scenes::take_out`].
    Gone,
}

/// What a process found.
pub(crate) struct Found {
    /// Microseconds of processor time of a pass; the first, before which
    /// pilots run, does not count.
    pub(crate) time: f64,
    /// The mean of the passes.
    pub(crate) picture: Image,
    /// A fingerprint of all samples.
    pub(crate) bits: u64,
}

impl Job {
    pub(crate) fn new(scene: &str) -> Self {
        Self {
            scene: scene.to_owned(),
            said: None,
            passes: PASSES[1],
        }
    }

    pub(crate) fn said(self, effect: Effect, said: Said) -> Self {
        Self {
            said: Some((effect, said)),
            ..self
        }
    }

    pub(crate) fn passes(self, passes: u32) -> Self {
        Self { passes, ..self }
    }

    /// The job that this process was started for.
    pub(crate) fn of_this_process() -> Option<Self> {
        let text = env::var(JOB).ok()?;
        let words: Vec<&str> = text.split(';').collect();
        let &[scene, effect, said, passes] = words.as_slice() else {
            panic!("malformed job {text}");
        };
        Some(Self {
            scene: scene.to_owned(),
            said: Effect::named(effect).map(|e| {
                let is_on = said == "on";
                (e, if is_on { Said::On } else { Said::Gone })
            }),
            passes: passes.parse().unwrap_or_else(|e| panic!("{e}")),
        })
    }

    /// Runs the passes and prints what is [`Found`].
    pub(crate) fn run(&self) {
        // No thread waits for another: waiting takes instructions, too.
        let pool = rayon::ThreadPoolBuilder::new().num_threads(1);
        let pool = pool.use_current_thread();
        pool.build_global().unwrap_or_else(|e| panic!("{e}"));
        let mut scene = scenes::named(&self.scene);
        let mut settings = Settings {
            photons: Some(PHOTONS),
            ..scene.settings.clone()
        };
        match self.said {
            Some((effect, Said::On)) => settings.effects.set(effect, Choice::On),
            Some((effect, Said::Gone)) => scenes::take_out(&mut scene, &mut settings, effect),
            None => {}
        }
        let renderer = Renderer::new(&scene, &settings, SIZE, [0, 0, SIZE[0], SIZE[1]]);
        let mut sums = vec![Rgb::BLACK; (SIZE[0] * SIZE[1]) as usize];
        let mut bits = 0u64;
        let mut clock = None;
        for pass in 0..self.passes {
            for (sum, sample) in sums.iter_mut().zip(renderer.pass(pass).samples) {
                *sum += sample.total();
                for value in sample.layers.iter().flat_map(|l| [l[0], l[1], l[2]]) {
                    // FNV-1a, by words. The sign of a zero is none of a picture.
                    bits = (bits ^ (value + 0.0).to_bits()).wrapping_mul(0x0100_0000_01b3);
                }
            }
            clock.get_or_insert_with(Clock::start);
        }
        let seconds = clock.map_or(0.0, |c| c.seconds());
        let micros = seconds * 1e6 / f64::from(self.passes.max(2) - 1);
        let means = sums.iter().flat_map(|&s| {
            let mean = s / f64::from(self.passes);
            [mean[0], mean[1], mean[2]]
        });
        let words: Vec<String> = means.map(|v| v.to_string()).collect();
        crate::say(&format!("{micros} {bits} {}", words.join(" ")));
    }

    /// What a program finds.
    pub(crate) fn by(&self, program: &Path) -> Found {
        let output = self.output(&mut Command::new(program));
        let text = String::from_utf8_lossy(&output.stdout);
        let mut words = text.split_whitespace();
        let mut next = || words.next().unwrap_or_else(|| panic!("{self}: {text}"));
        let number = |word: &str| -> f64 { word.parse().unwrap_or_else(|e| panic!("{word}: {e}")) };
        let time = number(next());
        let bits = next().parse().unwrap_or_else(|e| panic!("{self}: {e}"));
        let picture = Image::from_fn(SIZE[0], SIZE[1], |_, _| {
            let [r, g, b] = [number(next()), number(next()), number(next())];
            Rgb::new(r, g, b)
        });
        Found {
            time,
            picture,
            bits,
        }
    }

    /// What a pass takes: instructions, or microseconds without valgrind.
    pub(crate) fn cost(&self, program: &Path) -> f64 {
        if !has_valgrind() {
            let times = (0..TRIES).map(|_| self.by(program).time);
            return times.fold(f64::INFINITY, f64::min);
        }
        let [few, many] = PASSES.map(|n| self.clone().passes(n).instructions(program));
        (many - few) / f64::from(PASSES[1] - PASSES[0])
    }

    fn instructions(&self, program: &Path) -> f64 {
        let output = self.output(
            Command::new("valgrind")
                .args(["--tool=callgrind", "--callgrind-out-file=/dev/null"])
                .arg(program),
        );
        let text = String::from_utf8_lossy(&output.stderr);
        let count = text.lines().find_map(|l| l.split_once("Collected :"));
        let count = count.unwrap_or_else(|| panic!("{self}: {text}")).1.trim();
        count.parse().unwrap_or_else(|e| panic!("{count}: {e}"))
    }

    fn output(&self, command: &mut Command) -> Output {
        let output = command.env(JOB, self.to_string()).output();
        let output = output.unwrap_or_else(|e| panic!("{command:?}: {e}"));
        assert!(output.status.success(), "{self}: {output:?}");
        output
    }
}

impl fmt::Display for Job {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (effect, said) = match self.said {
            None => ("", ""),
            Some((effect, Said::On)) => (effect.name(), "on"),
            Some((effect, Said::Gone)) => (effect.name(), "gone"),
        };
        write!(f, "{};{effect};{said};{}", self.scene, self.passes)
    }
}

pub(crate) fn has_valgrind() -> bool {
    let found = Command::new("valgrind").arg("--version").output();
    found.is_ok_and(|o| o.status.success())
}
