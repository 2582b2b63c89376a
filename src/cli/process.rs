//! What a command sets for the whole process: its threads, and what Ctrl-C does.

use crate::cli::console::print_error;
use crate::cli::exit::INTERRUPTED;
use lumiduct_base::error::Error;
use lumiduct_core::transport::{Interrupt, StopAnswer};

/// Sets the number of threads, all cores if none is given.
pub(super) fn use_threads(threads: Option<u16>) -> Result<(), Error> {
    let Some(threads) = threads else { return Ok(()) };
    rayon::ThreadPoolBuilder::new()
        .num_threads(usize::from(threads))
        .build_global()
        .map_err(|reason| Error::Usage(format!("--threads {threads}: {reason}")))
}

/// A flag that Ctrl-C sets. It ends tracing; a second Ctrl-C, or one while nothing is traced, ends
/// the program.
pub(super) fn on_ctrl_c() -> Interrupt {
    let interrupt = Interrupt::default();
    let on_signal = interrupt.clone();
    // Without a handler Ctrl-C ends the program at once, which is no reason not to run.
    _ = ctrlc::set_handler(move || match on_signal.request() {
        StopAnswer::EndRun => {}
        StopAnswer::EndProgram => {
            print_error("interrupted: the program ends and writes nothing more\n");
            std::process::exit(INTERRUPTED.into());
        }
    });
    interrupt
}
