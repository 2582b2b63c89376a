//! How runs and batches show their progress.

use crate::cli::console::print_error;
use crate::optimise::OptimisationProgress;
use crate::pipeline::Progress;
use crate::study::BatchProgress;
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
            Self::Bar(bar) => gathering.iter().for_each(|line| bar.println(line)),
            Self::Lines { .. } => {
                gathering.iter().for_each(|line| print_error(&format!("{line}\n")));
            }
        }
        self.show_line(progress.fraction(), progress.elapsed, &progress.sentence());
    }

    /// Designs done, and the time left.
    pub(super) fn show_batch(&mut self, progress: &BatchProgress) {
        self.show_line(progress.fraction, progress.elapsed, &progress.sentence());
    }

    /// The measurement at work, and the best so far.
    pub(super) fn show_optimisation(&mut self, progress: &OptimisationProgress) {
        self.show_line(progress.fraction, progress.elapsed, &progress.sentence());
    }

    /// The share of a part that is done, 0..=1, and the time left.
    pub(super) fn show_share(&mut self, share: f64, elapsed: Duration) {
        let left = elapsed.as_secs_f64() * (1.0 - share) / share.max(1e-9);
        self.show_line(share, elapsed, &format!("{:.0} % done, {left:.0} s left", 100.0 * share));
    }

    fn show_line(&mut self, share: f64, elapsed: Duration, line: &str) {
        match self {
            Self::Quiet => {}
            Self::Bar(bar) => {
                bar.set_position((1000.0 * share) as u64);
                bar.set_message(line.to_owned());
            }
            Self::Lines { next } => {
                if elapsed >= *next {
                    print_error(&format!("{line}\n"));
                    *next = elapsed + Self::LINE_EVERY;
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
