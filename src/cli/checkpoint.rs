//! Checkpoints of a render: what it goes on from, and what it leaves on the way.

use std::{
    path::{Path, PathBuf},
    time::{Duration, Instant},
};

use nephroid::render::{Job, Part, Subject};

use super::{Failure, args::RenderArgs, tell};

/// Time between two checkpoints, if none is given.
const EVERY: Duration = Duration::from_secs(60);

/// The file that `render` keeps: the one it was told to, or the one it goes on
/// from.
pub(super) fn file(typed: &RenderArgs) -> Option<&Path> {
    typed
        .checkpoint
        .as_ref()
        .or(typed.resume.as_ref())
        .map(PathBuf::as_path)
}

/// The passes to go on from: those of `--resume`, or those of the checkpoint of
/// an earlier run of the same command, whichever are more; none otherwise.
pub(super) fn start(typed: &RenderArgs, job: &Job, subject: Subject) -> Result<Part, Failure> {
    let mut found: Vec<(&Path, Part)> = Vec::new();
    let kept = typed.checkpoint.as_deref().filter(|path| path.exists());
    for path in typed.resume.as_deref().into_iter().chain(kept) {
        if found.iter().any(|(known, _)| *known == path) {
            continue;
        }
        let part =
            Part::load(path).map_err(|e| Failure::bad_input(format!("{}: {e}", path.display())))?;
        check(&part, job, typed, &subject).map_err(|reason| {
            let remedy = if typed.resume.as_deref() == Some(path) {
                "render with what it was made with, or without --resume"
            } else {
                "give --checkpoint another name, or remove the file if it is not needed"
            };
            let path = path.display();
            Failure::bad_input(format!(
                "{path} does not belong to this render: {reason}; {remedy}"
            ))
        })?;
        found.push((path, part));
    }
    let Some((path, part)) = found.into_iter().max_by_key(|(_, part)| part.passes()) else {
        return Ok(Part::new(subject));
    };
    if !typed.quiet {
        let done = part.passes();
        tell(format_args!(
            "going on from {}: {done} passes are done",
            path.display()
        ));
    }
    Ok(part)
}

/// Whether the render can go on from a part; else why not.
fn check(part: &Part, job: &Job, typed: &RenderArgs, subject: &Subject) -> Result<(), String> {
    if let Some(difference) = part.subject().difference(subject) {
        return Err(difference);
    }
    let first = u64::from(job.first_pass);
    match &part.runs()[..] {
        [] => Ok(()),
        [run] if run.start == first => {
            // With a time or an error given only what was typed is a limit.
            let limit = typed.passes.map(|p| p.end).or_else(|| {
                let all = job.settings.passes;
                (job.time.is_none() && job.error.is_none()).then_some(all)
            });
            match limit {
                Some(end) if u64::from(end) < run.end => Err(format!(
                    "it has {} passes already, more than the {end} asked for (ask for more: --passes {})",
                    run.end, run.end
                )),
                _ => Ok(()),
            }
        }
        runs => {
            let runs: Vec<String> = runs
                .iter()
                .map(|r| format!("{}..{}", r.start, r.end))
                .collect();
            Err(format!(
                "it has the passes {}, but the render starts with pass {first}",
                runs.join(" and ")
            ))
        }
    }
}

/// Writes checkpoints.
pub(super) struct Keeper<'a> {
    path: &'a Path,
    every: Duration,
    /// When the last attempt ended.
    last: Instant,
    /// Passes in the file, if this render has written it.
    saved: Option<u32>,
    /// What went wrong in the last attempt.
    fault: Option<String>,
}

impl<'a> Keeper<'a> {
    /// The keeper that was asked for, if any.
    pub(super) fn of(typed: &'a RenderArgs) -> Option<Self> {
        Some(Self {
            path: file(typed)?,
            every: typed.checkpoint_every.unwrap_or(EVERY),
            last: Instant::now(),
            saved: None,
            fault: None,
        })
    }

    /// Writes a checkpoint if it is time.
    pub(super) fn after_pass(&mut self, part: &Part) {
        if self.last.elapsed() < self.every {
            return;
        }
        let before = self.fault.take();
        self.fault = self.write(part).err();
        match (&self.fault, &before) {
            // Said once, not with every attempt.
            (Some(fault), before) if before.as_ref() != Some(fault) => tell(format_args!(
                "\nwarning: {fault}\nthe render goes on and tries again; an older checkpoint is kept"
            )),
            (None, Some(_)) => tell(format_args!("\n{} is written again", self.path.display())),
            _ => {}
        }
        self.last = Instant::now();
    }

    /// Writes the last checkpoint, if the file has not got it.
    pub(super) fn finish(mut self, part: &Part) -> Result<(), String> {
        if self.saved == Some(part.passes()) {
            return Ok(());
        }
        self.write(part)
    }

    fn write(&mut self, part: &Part) -> Result<(), String> {
        part.save(self.path).map_err(|e| e.to_string())?;
        self.saved = Some(part.passes());
        Ok(())
    }
}
