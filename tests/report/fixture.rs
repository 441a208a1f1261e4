//! A made-up study with everything that a real one can have: each curve is a
//! power law with a bias, and each run strays from it by a few per cent.

use std::{fs, path::Path};

use nephroid::{
    film::{Image, write_png},
    metrics::magma,
    spectrum::Rgb,
    study::{
        Absent, Effect, FORMAT, Fit, Machine, Picture, Point, Run, SceneStudy, Series, Setting,
        Split, Study, TimeTo, Truth, TruthKind,
    },
};

/// Errors that are asked for.
pub(crate) const TARGETS: [f64; 4] = [0.1, 0.03, 0.01, 0.003];

/// Size of the pictures.
const SIZE: [u32; 2] = [120, 80];

/// A number in -1..1 that looks random and depends on its address only.
fn stray(address: &[u64]) -> f64 {
    let mut state = 0x9e37_79b9_7f4a_7c15u64;
    for &part in address {
        state = (state ^ part).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        state ^= state >> 29;
    }
    (state >> 11) as f64 / (1u64 << 52) as f64 - 1.0
}

/// A curve: method, setting, error after a second, slope, bias, seconds a pass,
/// layers.
struct Law {
    method: &'static str,
    sweep: Option<(&'static str, &'static str)>,
    factor: f64,
    slope: f64,
    bias: f64,
    pass: f64,
    layers: &'static [&'static str],
}

fn law(method: &'static str, factor: f64, slope: f64, bias: f64, pass: f64) -> Law {
    Law {
        method,
        sweep: None,
        factor,
        slope,
        bias,
        pass,
        layers: &[],
    }
}

fn laws() -> Vec<Law> {
    let radius = |value, factor, bias| Law {
        sweep: Some(("radius", value)),
        ..law("photon", factor, -0.6, bias, 0.11)
    };
    vec![
        law("photon", 0.035, -0.66, 0.0, 0.12),
        law("sppm", 0.11, -0.43, 0.002, 0.1),
        law("path", 1.9, -0.5, 0.0, 0.05),
        law("light", 0.42, -0.5, 0.0, 0.07),
        law("bdpt", 0.3, -0.5, 0.0, 0.16),
        law("metropolis", 0.21, -0.45, 0.0, 0.09),
        Law {
            layers: &["direct", "caustic"],
            ..law("whitted", 0.05, -0.05, 0.03, 0.02)
        },
        radius("0.5", 0.05, 0.0),
        radius("2", 0.026, 0.003),
        radius("4", 0.02, 0.012),
    ]
}

impl Law {
    fn label(&self) -> String {
        let sweep = self.sweep.map(|(name, value)| format!(", {name} {value}"));
        format!("{}{}", self.method, sweep.unwrap_or_default())
    }

    fn noise(&self, seconds: f64) -> f64 {
        self.factor * libm::pow(seconds, self.slope)
    }

    fn point(&self, scene: u64, place: u64, passes: u32) -> Point {
        let run = |seed: u64| {
            let stray = |k: u64| stray(&[scene, place, u64::from(passes), seed, k]);
            let cpu_seconds = self.pass * f64::from(passes) * (1.0 + 0.04 * stray(0));
            let noise = self.noise(cpu_seconds) * (1.0 + 0.12 * stray(1));
            let relmse = noise * noise + self.bias * self.bias;
            Run {
                seed,
                wall_seconds: cpu_seconds / 1.9,
                cpu_seconds,
                relmse,
                relmse_trimmed: 0.6 * relmse,
                rmse: 0.3 * libm::sqrt(relmse),
                mean_ratio: 1.0 + 0.01 * stray(2),
                flip: 0.4 * libm::sqrt(relmse),
                stated: (self.method == "photon").then_some(1.1 * noise),
            }
        };
        let noise = self.noise(self.pass * f64::from(passes));
        Point {
            passes,
            runs: (1..=4).map(run).collect(),
            split: Some(Split {
                noise,
                bias: if noise > 4.0 * self.bias {
                    0.0
                } else {
                    self.bias
                },
            }),
        }
    }

    fn series(&self, scene: u64, place: u64) -> Series {
        let passes = (0..8).map(|k| 1u32 << k);
        let points: Vec<Point> = passes.map(|p| self.point(scene, place, p)).collect();
        let last = self.pass * 128.0;
        let time = |error: f64| {
            let left = error * error - self.bias * self.bias;
            let seconds = libm::pow(libm::sqrt(left) / self.factor, 1.0 / self.slope);
            TimeTo {
                error,
                cpu_seconds: (left > 0.0 && seconds < 1e5).then_some(seconds),
                extrapolated: seconds > last,
            }
        };
        let name = format!("{}-{scene}-{place}", self.method);
        let pictures = [4, 32, 128].map(|passes| Picture {
            passes,
            seed: 1,
            cpu_seconds: self.pass * f64::from(passes),
            error: self.noise(self.pass * f64::from(passes)),
            file: format!("pictures/{name}-{passes}.png"),
            map: format!("pictures/{name}-{passes}-error.png"),
        });
        Series {
            label: self.label(),
            method: self.method.to_owned(),
            sweep: self.sweep.map(|(name, value)| Setting {
                name: name.to_owned(),
                value: value.to_owned(),
            }),
            blind_spots: match self.layers {
                [] => vec![],
                _ => vec!["It does not see light between diffuse surfaces.".to_owned()],
            },
            layers: self.layers.iter().map(|&l| l.to_owned()).collect(),
            points,
            fit: Some(Fit {
                factor: self.factor,
                slope: self.slope,
                slope_interval: [self.slope - 0.04, self.slope + 0.05],
            }),
            times: TARGETS.map(time).to_vec(),
            pictures: if self.sweep.is_none() {
                pictures.to_vec()
            } else {
                vec![]
            },
        }
    }
}

/// One scene with every kind of contents.
fn scene(index: u64, name: &str, title: &str, kind: TruthKind) -> SceneStudy {
    let laws = laws();
    // Not every scene has every method, nor sweeps.
    let kept = laws.iter().enumerate().filter(|(i, law)| {
        index == 0 || (law.sweep.is_none() && !(*i as u64 + index).is_multiple_of(5))
    });
    let series = kept.map(|(i, law)| law.series(index, i as u64)).collect();
    SceneStudy {
        name: name.to_owned(),
        title: title.to_owned(),
        resolution: SIZE,
        truth: Truth {
            kind,
            words: "The mean of long runs of bidirectional path tracing.".to_owned(),
            method: Some("bdpt".to_owned()),
            seeds: 8,
            passes: 4096,
            error: Some(0.0011),
            cpu_seconds: Some(5300.0),
            picture: Some(format!("pictures/truth-{index}.png")),
        },
        series,
        absent: vec![Absent {
            method: "light tracing through the lens".to_owned(),
            reason: "The camera sees the caustic through glass.".to_owned(),
        }],
        effects: [("caustics", 0.27), ("indirect", 0.11), ("glints", -0.001)]
            .into_iter()
            .map(|(name, light)| Effect {
                name: name.to_owned(),
                title: format!("light of {name}"),
                light,
                light_error: 0.002,
                with_seconds: 10.0,
                without_seconds: 10.0 - 9.0 * light,
                with_error: Some(0.031),
                without_error: (light > 0.0).then_some(2.0 * light),
            })
            .collect(),
    }
}

/// The study.
pub(crate) fn study() -> Study {
    Study {
        format: FORMAT,
        software: "nephroid 0.1.0".to_owned(),
        made: "2026-01-02T03:04:05Z".to_owned(),
        machine: Machine {
            processor: "A processor at 3 GHz".to_owned(),
            cores: 2,
            threads: 2,
            system: "linux x86_64".to_owned(),
        },
        scenes: vec![
            scene(
                0,
                "glass_sphere",
                "A ball of glass gathers the light of a small lamp on a floor.",
                TruthKind::Made,
            ),
            scene(
                1,
                "ring",
                "Light within a metal ring draws a nephroid.",
                TruthKind::ClosedForm,
            ),
            scene(
                2,
                "Wasserglas größer 光",
                "Waves of water on the ground of a pool.",
                TruthKind::Given,
            ),
        ],
    }
}

/// A study with no scene but `scene`.
pub(crate) fn alone(scene: SceneStudy) -> Study {
    Study {
        scenes: vec![scene],
        ..study()
    }
}

/// A picture of a caustic's rough shape, the less noisy the smaller `error`.
fn picture(error: f64, salt: u64) -> Image {
    let [width, height] = SIZE;
    Image::from_fn(width, height, |x, y| {
        let u = f64::from(x) / f64::from(width) * 2.0 - 1.0;
        let v = f64::from(y) / f64::from(height) * 2.0 - 1.0;
        let bow = (u * u + (v + 0.3) * (v + 0.3) - 0.4).abs();
        let light = 0.1 + 0.1 * (1.0 - v) + 0.05 / (0.04 + bow);
        let noise = 1.0 + 3.0 * error * stray(&[u64::from(x), u64::from(y), salt]);
        Rgb::new(light, 0.9 * light, 0.7 * light) * noise.max(0.0)
    })
}

/// Puts the pictures that `study` names into `directory`.
pub(crate) fn put_pictures(study: &Study, directory: &Path) {
    fs::create_dir_all(directory.join("pictures")).unwrap();
    for scene in &study.scenes {
        if let Some(file) = &scene.truth.picture {
            write_png(&directory.join(file), &picture(0.0, 0), Some(0.0)).unwrap();
        }
        for shot in scene.series.iter().flat_map(|s| &s.pictures) {
            let salt = u64::from(shot.passes);
            let image = picture(shot.error, salt);
            write_png(&directory.join(&shot.file), &image, Some(0.0)).unwrap();
            let map = Image::from_fn(SIZE[0], SIZE[1], |x, y| {
                magma(6.0 * shot.error * stray(&[u64::from(x), u64::from(y), salt]).abs())
            });
            write_png(&directory.join(&shot.map), &map, Some(0.0)).unwrap();
        }
    }
}
