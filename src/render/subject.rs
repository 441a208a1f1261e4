//! What is rendered: all that passes must have in common to be summed.

use serde::{Deserialize, Serialize};

use super::{Job, Renderer};
use crate::{
    plan::{film_quantum, judge},
    sampling::{Purpose, Sequence},
    scene::{self, Digest, Guidance, Input, Kernel, Sampler, Scene, Settings},
    spectrum::Rgb,
};

/// Starts with which the power that is not aimed at casters is estimated.
const NOT_AIMED_SAMPLES: u64 = 4096;

/// The name of the renderer's own method, beside those of the references.
const PHOTONS: &str = "photons";

/// What a report says of a light beside its ledger.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct LightFacts {
    /// Name of the light.
    pub name: String,
    /// Emitted power in W; `None` for a sun.
    pub power: Option<f64>,
    /// Power not aimed at casters, from a pilot, and its standard error.
    pub not_aimed: Option<(f64, f64)>,
}

/// What is rendered. Passes of equal subjects are passes of one picture: the
/// subject holds what a pass depends on beside its index, and what a report
/// says that no sum knows.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Subject {
    /// Version of the software.
    pub version: String,
    /// Name of the method.
    pub method: String,
    /// The files of the scene.
    pub inputs: Vec<Input>,
    /// What else a reference method was told; empty if nothing.
    pub options: String,
    /// Width and height of the whole picture in pixels.
    pub resolution: [u32; 2],
    /// The rendered window: x, y, width, height in pixels.
    pub window: [u32; 4],
    /// Seed.
    pub seed: u64,
    /// Photon paths of a pass of the first round; 0 where there are none.
    pub photons_per_pass: u64,
    /// Most photon paths of a pass of any round; 0 where there are none.
    pub most_photons: u64,
    /// Kernel radius of the first round in pixel footprints.
    pub radius: f64,
    /// The points at which photons and camera look.
    pub sampler: Sampler,
    /// The area over which a photon's light is spread.
    pub kernel: Kernel,
    /// What decides where photons and shadow rays go.
    pub guidance: Guidance,
    /// What was said about effects.
    pub effects_wanted: String,
    /// Names of the effects that are simulated; none for a reference method.
    pub effects: Vec<String>,
    /// Whether light between diffuse surfaces was asked for.
    pub indirect_wanted: bool,
    /// Whether it was simulated.
    pub indirect: bool,
    /// Whether caustic photons were traced.
    pub caustics: bool,
    /// Longest chain of surface interactions.
    pub max_depth: u32,
    /// Exposure of the PNG in stops.
    pub exposure: Option<f64>,
    /// The film's unit.
    pub quantum: f64,
    /// Lights in the order of the scene; none for a reference method.
    pub lights: Vec<LightFacts>,
    /// What of the scene a reference method cannot see.
    pub blind_spots: Vec<String>,
}

impl Subject {
    /// What `renderer` renders, which was made for `scene` and `job`.
    pub fn of(scene: &Scene, job: &Job, renderer: &Renderer<'_>) -> Self {
        let light = |(i, light): (usize, &crate::scene::NamedLight)| LightFacts {
            name: light.name.clone(),
            power: light.light.power().map(Rgb::mean),
            not_aimed: renderer.emitter().and_then(|e| {
                let pilot = Sequence::new(job.settings.seed, Purpose::Pilot, 1, i as u64);
                e.aims()[i].not_aimed(pilot, NOT_AIMED_SAMPLES)
            }),
        };
        Self {
            photons_per_pass: renderer.photons(),
            most_photons: renderer.most_photons(),
            effects: judge(scene, &job.settings)
                .iter()
                .filter(|verdict| verdict.on)
                .map(|verdict| verdict.effect.name().to_owned())
                .collect(),
            indirect: renderer.plan().indirect,
            caustics: renderer.emitter().is_some(),
            lights: scene.lights.iter().enumerate().map(light).collect(),
            ..Self::without_photons(scene, job, PHOTONS)
        }
    }

    /// What a method without photons renders.
    pub(crate) fn without_photons(scene: &Scene, job: &Job, method: &str) -> Self {
        // Every setting counts but three: the range of the passes is no part of
        // what they are, and the paths of a pass follow from the other two.
        let Settings {
            passes: _,
            photons: _,
            memory: _,
            seed,
            radius,
            sampler,
            kernel,
            guidance,
            indirect,
            effects,
            max_depth,
            exposure,
        } = job.settings;
        Self {
            version: env!("CARGO_PKG_VERSION").to_owned(),
            method: method.to_owned(),
            options: String::new(),
            inputs: scene.inputs.clone(),
            resolution: job.resolution,
            window: job.window(),
            seed,
            photons_per_pass: 0,
            most_photons: 0,
            radius,
            sampler,
            kernel,
            guidance,
            effects_wanted: effects.to_string(),
            effects: Vec::new(),
            indirect_wanted: indirect,
            indirect: false,
            caustics: false,
            max_depth,
            exposure,
            quantum: film_quantum(scene).unit(),
            lights: Vec::new(),
            blind_spots: Vec::new(),
        }
    }

    /// A fingerprint of all files of the scene.
    pub fn fingerprint(&self) -> Digest {
        scene::fingerprint(&self.inputs)
    }

    /// Whether the renderer's own method is at work.
    pub fn is_by_photons(&self) -> bool {
        self.method == PHOTONS
    }

    /// The first difference between what is there and what is wanted, in
    /// words; `None` if there is none.
    pub fn difference(&self, wanted: &Self) -> Option<String> {
        let pair = |what: &str, there: &dyn ToString, wanted: &dyn ToString| {
            let (there, wanted) = (there.to_string(), wanted.to_string());
            (there != wanted).then(|| format!("{what} is {there} there and {wanted} here"))
        };
        let size = |[w, h]: [u32; 2]| format!("{w}x{h}");
        let window = |[x, y, w, h]: [u32; 4]| format!("{x},{y},{w}x{h}");
        let optional = |value: Option<f64>| value.map_or("automatic".to_owned(), |v| v.to_string());
        pair("the version of nephroid", &self.version, &wanted.version)
            .or_else(|| changed_input(&self.inputs, &wanted.inputs))
            .or_else(|| pair("the method", &self.method, &wanted.method))
            .or_else(|| pair("the option", &self.options, &wanted.options))
            .or_else(|| {
                let [there, here] = [self.resolution, wanted.resolution].map(size);
                pair("the resolution", &there, &here)
            })
            .or_else(|| {
                let [there, here] = [self.window, wanted.window].map(window);
                pair("the crop", &there, &here)
            })
            .or_else(|| pair("the seed", &self.seed, &wanted.seed))
            .or_else(|| {
                let what = "the number of photons in a pass";
                pair(what, &self.photons_per_pass, &wanted.photons_per_pass)
            })
            .or_else(|| {
                let what = "the largest number of photons in a pass";
                pair(what, &self.most_photons, &wanted.most_photons)
            })
            .or_else(|| pair("the radius", &self.radius, &wanted.radius))
            .or_else(|| {
                let [there, here] = [self.sampler, wanted.sampler].map(|s| format!("{s:?}"));
                pair("the sampler", &there, &here)
            })
            .or_else(|| {
                let [there, here] = [self.kernel, wanted.kernel].map(|k| format!("{k:?}"));
                pair("the kernel", &there, &here)
            })
            .or_else(|| {
                let [there, here] = [self.guidance, wanted.guidance].map(|g| format!("{g:?}"));
                pair("the guidance", &there, &here)
            })
            .or_else(|| {
                let [there, here] = [self.indirect_wanted, wanted.indirect_wanted];
                pair("the setting `indirect`", &there, &here)
            })
            .or_else(|| {
                let what = "the list of effects";
                pair(what, &self.effects_wanted, &wanted.effects_wanted)
            })
            .or_else(|| pair("the depth limit", &self.max_depth, &wanted.max_depth))
            .or_else(|| {
                let [there, here] = [self.exposure, wanted.exposure].map(optional);
                pair("the exposure", &there, &here)
            })
            .or_else(|| {
                // What is left follows from the scene and the program.
                let is_same = self.bytes() == wanted.bytes();
                let text = "another build of nephroid understands the scene differently";
                (!is_same).then(|| text.to_owned())
            })
    }

    /// All of it as bytes; equal ones for equal subjects.
    pub(super) fn bytes(&self) -> Vec<u8> {
        postcard::to_allocvec(self).expect("plain data in memory")
    }
}

/// The first file that is not the same.
fn changed_input(there: &[Input], here: &[Input]) -> Option<String> {
    let pairs = there.iter().zip(here);
    for (there, here) in pairs {
        if there.name != here.name {
            let (there, here) = (&there.name, &here.name);
            return Some(format!("the scene reads {there} there and {here} here"));
        }
        if there.digest != here.digest {
            return Some(format!("{} has changed", here.name));
        }
    }
    let (more, what) = if there.len() > here.len() {
        (&there[here.len()..], "only there")
    } else {
        (&here[there.len()..], "only here")
    };
    let first = more.first()?;
    Some(format!("the scene reads {} {what}", first.name))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn subject() -> Subject {
        let input = |name: &str| Input {
            name: name.to_owned(),
            digest: Digest::of(name.as_bytes()),
        };
        Subject {
            version: "1".to_owned(),
            method: PHOTONS.to_owned(),
            options: "--patches 3".to_owned(),
            inputs: vec![input("the scene file"), input("a.ply")],
            resolution: [8, 6],
            window: [0, 0, 8, 6],
            seed: 1,
            photons_per_pass: 9,
            most_photons: 99,
            radius: 2.0,
            sampler: Sampler::Sobol,
            kernel: Kernel::Footprint,
            guidance: Guidance::Learned,
            effects_wanted: "auto".to_owned(),
            effects: vec!["caustics".to_owned()],
            indirect_wanted: true,
            indirect: true,
            caustics: true,
            max_depth: 64,
            exposure: None,
            quantum: 1.0,
            lights: vec![LightFacts {
                name: "lamp".to_owned(),
                power: Some(1.0),
                // What an estimate from nothing may come to.
                not_aimed: Some((0.0, f64::NAN)),
            }],
            blind_spots: vec![],
        }
    }

    #[test]
    fn equal_subjects_do_not_differ() {
        assert_eq!(subject().difference(&subject()), None);
    }

    #[test]
    fn every_difference_is_named() {
        type Change = fn(&mut Subject);
        let changes: [(Change, &str); 21] = [
            (
                |s| s.version.push('2'),
                "version of nephroid is 1 there and 12 here",
            ),
            (|s| s.method.push('x'), "method"),
            (
                |s| s.options.push('2'),
                "option is --patches 3 there and --patches 32 here",
            ),
            (
                |s| s.inputs[0].digest.0[5] ^= 1,
                "the scene file has changed",
            ),
            (|s| s.inputs[1].digest.0[0] ^= 1, "a.ply has changed"),
            (
                |s| s.inputs[1].name.push('2'),
                "a.ply there and a.ply2 here",
            ),
            (|s| s.inputs.truncate(1), "reads a.ply only there"),
            (
                |s| s.resolution = [9, 6],
                "resolution is 8x6 there and 9x6 here",
            ),
            (
                |s| s.window = [1, 0, 7, 6],
                "crop is 0,0,8x6 there and 1,0,7x6 here",
            ),
            (|s| s.seed = 2, "seed is 1 there and 2 here"),
            (
                |s| s.photons_per_pass = 10,
                "photons in a pass is 9 there and 10 here",
            ),
            (
                |s| s.most_photons = 98,
                "largest number of photons in a pass is 99 there and 98 here",
            ),
            (|s| s.radius = 2.5, "radius is 2 there and 2.5 here"),
            (
                |s| s.sampler = Sampler::Independent,
                "sampler is Sobol there",
            ),
            (|s| s.kernel = Kernel::Circle, "kernel is Footprint there"),
            (
                |s| s.guidance = Guidance::Power,
                "guidance is Learned there and Power here",
            ),
            (
                |s| s.indirect_wanted = false,
                "`indirect` is true there and false here",
            ),
            (
                |s| s.effects_wanted = "glints=off".to_owned(),
                "list of effects is auto there and glints=off here",
            ),
            (|s| s.max_depth = 65, "depth limit is 64 there and 65 here"),
            (
                |s| s.exposure = Some(1.5),
                "exposure is automatic there and 1.5 here",
            ),
            (|s| s.lights[0].power = Some(1.5), "another build"),
        ];
        for (change, says) in changes {
            let mut other = subject();
            change(&mut other);
            let said = subject().difference(&other).unwrap_or_default();
            assert!(said.contains(says), "{said} / {says}");
        }
        let mut more = subject();
        more.inputs.push(more.inputs[0].clone());
        let said = subject().difference(&more).unwrap_or_default();
        assert!(said.ends_with("only here"), "{said}");
    }
}
