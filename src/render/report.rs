//! What a render says about itself.

use std::fmt;

use serde::Serialize;

use crate::{
    metrics::{Figures, Statement},
    photon::{LightTally, Tally},
};

/// One light's part in the photon passes. Powers are in W, means over the
/// colour channels.
#[derive(Clone, Debug, Serialize)]
pub struct LightReport {
    /// Name of the light.
    pub name: String,
    /// Emitted power; `None` for a sun.
    pub power: Option<f64>,
    /// Power launched towards casters, estimated from all paths.
    pub launched: f64,
    /// Power not aimed at casters, from a pilot, and its standard error.
    pub not_aimed: Option<(f64, f64)>,
    /// The ledger, in W.
    pub ledger: LightTally,
}

/// What a picture says about its error.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct ErrorReport {
    /// The relative error that was asked for.
    pub target: Option<f64>,
    /// Of all lit pixels.
    pub lit: Figures,
    /// Of those that owe more than a tenth of their light to caustics.
    pub caustics: Option<Figures>,
}

impl ErrorReport {
    pub(super) fn of(statement: &Statement, target: Option<f64>) -> Self {
        Self {
            target,
            lit: statement.whole,
            caustics: statement.caustics,
        }
    }
}

/// What a growing picture said about its error after a number of full rounds.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct RoundReport {
    /// The passes of these rounds.
    pub passes: u32,
    /// As [`ErrorReport`] has it.
    pub lit: Figures,
    /// As [`ErrorReport`] has it.
    pub caustics: Option<Figures>,
}

impl RoundReport {
    /// What a picture of so many passes states.
    pub fn of(passes: u32, statement: &Statement) -> Self {
        Self {
            passes,
            lit: statement.whole,
            caustics: statement.caustics,
        }
    }
}

impl fmt::Display for ErrorReport {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Figures {
            error,
            bound,
            noise,
            bias,
            ..
        } = self.lit;
        let [error, bound, noise, bias] = [error, bound, noise, bias].map(|e| 100.0 * e);
        write!(
            f,
            "error {error:.2} % (noise {noise:.2} %, bias {bias:.2} %), at most {bound:.2} % at 90 %"
        )?;
        if let Some(caustics) = &self.caustics {
            let [error, bound] = [caustics.error, caustics.bound].map(|e| 100.0 * e);
            write!(f, "; in the caustics {error:.2} %, at most {bound:.2} %")?;
        }
        Ok(())
    }
}

impl fmt::Display for RoundReport {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let [error, bound] = [self.lit.error, self.lit.bound].map(|e| 100.0 * e);
        let passes = self.passes;
        write!(
            f,
            "after {passes} passes of full rounds {error:.2} %, at most {bound:.2} %"
        )
    }
}

/// The report of a finished or interrupted render.
#[derive(Clone, Debug, Serialize)]
pub struct Report {
    /// Version of the software.
    pub version: String,
    /// Width and height of the rendered window in pixels.
    pub size: [u32; 2],
    /// Seed.
    pub seed: u64,
    /// Passes finished.
    pub passes: u32,
    /// Number of the first of them; not 0 for a part of a picture.
    pub first_pass: u64,
    /// Photon paths emitted.
    pub photons_emitted: u64,
    /// Photons stored.
    pub photons_stored: u64,
    /// Photons refused for not being finite; not zero is a defect.
    pub photons_refused: u64,
    /// Questions asked of the photon map.
    pub queries: u64,
    /// Candidates that trees offered to answer them.
    pub visited: u64,
    /// Kernels evaluated for it.
    pub tested: u64,
    /// Photons whose kernels reached the point asked for.
    pub accepted: u64,
    /// Photon paths of a pass of the first round.
    pub photons_per_pass: u64,
    /// Kernel radius of the first and the last round, in pixel footprints.
    pub radius: [f64; 2],
    /// Names of the effects that were simulated.
    pub effects: Vec<String>,
    /// Whether light between diffuse surfaces was simulated.
    pub indirect: bool,
    /// Whether caustic photons were traced.
    pub caustics: bool,
    /// Longest chain of surface interactions.
    pub max_depth: u32,
    /// Camera paths that the depth limit ended.
    pub camera_paths_truncated: u64,
    /// Share of the launched photon flux that the depth limit ended.
    pub flux_truncated: f64,
    /// Samples refused for not being finite; not zero is a defect.
    pub samples_refused: u64,
    /// Relative standard error of the picture, from the spread of the
    /// replicates: root of the mean of (noise / (value^2 + 0.01 mean^2)^(1/2))
    /// squared. `None` before the second replicate.
    pub noise: Option<f64>,
    /// What the picture says about its error; `None` before every replicate
    /// has a pass.
    pub error: Option<ErrorReport>,
    /// What it said after the last full round, if it ends inside the next. Like the
    /// seconds a matter of the run, not of the picture: a run that came in later,
    /// or only merged parts, has not seen it.
    pub last_round: Option<RoundReport>,
    /// Wall time in seconds; of merged parts the sum.
    pub seconds: f64,
    /// Lights in the order of the scene.
    pub lights: Vec<LightReport>,
}

impl Report {
    /// Turns the sums over `paths` emitted photon paths into power.
    pub(super) fn ledger(tally: &Tally, paths: u64) -> Vec<LightTally> {
        let k = if paths == 0 { 0.0 } else { 1.0 / paths as f64 };
        tally.lights.iter().map(|l| l.scaled(k)).collect()
    }
}

/// Share of light or paths above which the user is advised to act.
const WORTH_A_WORD: f64 = 1e-3;

/// A share in per cent, readable also where it is tiny.
fn percent(share: f64) -> String {
    if share == 0.0 || share >= 1e-4 {
        format!("{:.2} %", 100.0 * share)
    } else {
        format!("{:.0e} %", 100.0 * share)
    }
}

impl fmt::Display for Report {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} passes in {:.1} s", self.passes, self.seconds)?;
        if self.first_pass > 0 {
            let end = self.first_pass + u64::from(self.passes);
            write!(f, " ({}..{end})", self.first_pass)?;
        }
        if self.caustics {
            write!(
                f,
                ", {} photons emitted, {} stored",
                self.photons_emitted, self.photons_stored
            )?;
        } else {
            write!(f, ", no caustics")?;
        }
        if let (None, Some(noise)) = (&self.error, self.noise) {
            write!(f, ", noise {:.2} %", 100.0 * noise)?;
        }
        if !self.indirect {
            write!(
                f,
                "\nlight between diffuse surfaces is off or impossible: its layer is black"
            )?;
        }
        if self.flux_truncated > 0.0 || self.camera_paths_truncated > 0 {
            let cameras =
                f64::from(self.passes) * f64::from(self.size[0]) * f64::from(self.size[1]);
            let share = self.camera_paths_truncated as f64 / cameras;
            write!(
                f,
                "\ndepth limit {} ended {} of the camera paths and {} of the photons' flux",
                self.max_depth,
                percent(share),
                percent(self.flux_truncated)
            )?;
            if share.max(self.flux_truncated) > WORTH_A_WORD {
                write!(f, ": raise render.max_depth")?;
            }
        }
        if self.samples_refused + self.photons_refused > 0 {
            write!(
                f,
                "\n{} samples and {} photons were not finite and were left out",
                self.samples_refused, self.photons_refused
            )?;
        }
        Ok(())
    }
}
