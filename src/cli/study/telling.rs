//! How a study tells how far it is: a line on a terminal that changes, plain
//! lines elsewhere.

use std::{
    io::{self, IsTerminal},
    time::{Duration, Instant},
};

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use nephroid::study::Event;

use crate::cli::{progress::clock, tell};

/// Least time between two plain lines.
const LINE_EVERY: Duration = Duration::from_secs(5);

/// Tells of the events of a study.
pub(super) enum Telling {
    /// A line on a terminal.
    Bar(ProgressBar),
    /// Plain lines; when the last one was.
    Lines(Option<Instant>),
    /// Nothing.
    Quiet,
}

impl Telling {
    /// The way that suits where standard error goes.
    pub(super) fn new(quiet: bool) -> Self {
        if quiet {
            return Self::Quiet;
        }
        if !io::stderr().is_terminal() {
            return Self::Lines(None);
        }
        let bar = ProgressBar::with_draw_target(None, ProgressDrawTarget::stderr());
        let style = ProgressStyle::with_template("{msg}");
        bar.set_style(style.unwrap_or_else(|_| ProgressStyle::default_bar()));
        Self::Bar(bar)
    }

    /// Tells of an event.
    pub(super) fn show(&mut self, event: &Event) {
        let is_lasting = !matches!(event, Event::Working { .. });
        match self {
            Self::Bar(bar) if is_lasting => bar.suspend(|| tell(line(event))),
            Self::Bar(bar) => {
                bar.set_message(line(event));
                bar.tick();
            }
            Self::Lines(_) if is_lasting => tell(line(event)),
            Self::Lines(last) => {
                if last.is_none_or(|last| last.elapsed() >= LINE_EVERY) {
                    *last = Some(Instant::now());
                    tell(line(event));
                }
            }
            Self::Quiet => {}
        }
    }

    /// Takes the line away.
    pub(super) fn finish(self) {
        if let Self::Bar(bar) = self {
            bar.finish_and_clear();
        }
    }
}

fn line(event: &Event) -> String {
    match event {
        Event::Working {
            scene,
            task,
            passes,
            elapsed,
            limit,
        } => {
            let time = match limit {
                Some(limit) => format!("{} of {}", clock(*elapsed), clock(*limit)),
                None => clock(*elapsed),
            };
            format!("{scene}: {task}: pass {passes}, {time}")
        }
        Event::Note(text) => text.clone(),
        Event::Wrote(path) => format!("wrote {}", path.display()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines() {
        let mut event = Event::Working {
            scene: "cup".to_owned(),
            task: "path, seed 2 of 4".to_owned(),
            passes: 16,
            elapsed: Duration::from_secs(3),
            limit: Some(Duration::from_secs(15)),
        };
        assert_eq!(line(&event), "cup: path, seed 2 of 4: pass 16, 3s of 15s");
        if let Event::Working { limit, .. } = &mut event {
            *limit = None;
        }
        assert_eq!(line(&event), "cup: path, seed 2 of 4: pass 16, 3s");
    }
}
