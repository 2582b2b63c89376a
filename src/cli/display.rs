//! How a run shows its progress.

use crate::pipeline::Progress;
use indicatif::{ProgressBar, ProgressStyle};
use std::io::IsTerminal;
use std::time::Duration;

/// Progress on stderr: a bar on a terminal, a line now and then elsewhere, nothing when quiet.
pub(super) enum Display {
    Quiet,
    Bar(ProgressBar),
    Lines { next: Duration },
}

impl Display {
    /// Seconds between two lines when stderr is no terminal.
    const LINE_EVERY: Duration = Duration::from_secs(10);

    pub(super) fn new(quiet: bool) -> Self {
        if quiet {
            return Self::Quiet;
        }
        if !std::io::stderr().is_terminal() {
            return Self::Lines { next: Self::LINE_EVERY };
        }
        let bar = ProgressBar::new(1000);
        let style = ProgressStyle::with_template("{bar:30} {percent:>3} %  {msg}");
        Self::Bar(match style {
            Ok(style) => bar.with_style(style),
            Err(_) => bar,
        })
    }

    pub(super) fn show(&mut self, progress: &Progress) {
        let gathering = Some(&progress.gathering).filter(|text| !text.is_empty());
        let gathering = gathering.map(|text| format!("gathering: {text}"));
        match self {
            Self::Quiet => {}
            Self::Bar(bar) => {
                if let Some(line) = gathering {
                    bar.println(line);
                }
                bar.set_position((1000.0 * progress.fraction()) as u64);
                bar.set_message(progress.sentence());
            }
            Self::Lines { next } => {
                if let Some(line) = gathering {
                    eprintln!("{line}");
                }
                if progress.elapsed >= *next {
                    eprintln!("{}", progress.sentence());
                    *next = progress.elapsed + Self::LINE_EVERY;
                }
            }
        }
    }

    pub(super) fn close(&self) {
        if let Self::Bar(bar) = self {
            bar.finish_and_clear();
        }
    }
}
