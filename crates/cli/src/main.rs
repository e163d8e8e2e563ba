//! The `surfine` program: refines clouds of oriented points, on the GPU or the CPU.

mod adapters;
mod args;
mod bench;
mod cloud;
mod evaluate;
mod files;
mod fill;
mod holes;
mod memory;
mod need;
mod paint;
mod painter;
mod refine;
mod render;
mod sample;
mod scene;
mod summary;
mod watch;

use args::{Cli, Command};
use serde::Serialize;
use std::io::{ErrorKind, Write};
use std::process::ExitCode;

fn main() -> ExitCode {
    quiet_mesa();
    quiet_lost_devices();
    let cli = Cli::from_command_line();
    let result = match &cli.command {
        Command::Refine(args) => refine::run(args),
        Command::Holes(args) => holes::run(args),
        Command::Fill(args) => fill::run(args),
        Command::Render(args) => render::run(args),
        Command::Evaluate(args) => evaluate::run(args),
        Command::Adapters(args) => adapters::run(args),
        Command::Bench(args) => bench::run(args),
        Command::Sample(args) => sample::run(args),
    };
    match result {
        Ok(()) => ExitCode::SUCCESS,
        Err(Failure(message)) => {
            warn(&format!("error: {message}"));
            ExitCode::FAILURE
        }
    }
}

/// Lets the engine alone tell of a device that was lost: wgpu panics there, and the engine makes an error of it.
fn quiet_lost_devices() {
    let usual = std::panic::take_hook();
    std::panic::set_hook(Box::new(move |panic| {
        let text = panic.payload().downcast_ref::<String>();
        if !text.is_some_and(|text| text.starts_with(surfine::LOST)) {
            usual(panic);
        }
    }));
}

/// Tells a Mesa layer to stay out: it chooses among devices for windows and complains where there are none.
fn quiet_mesa() {
    if std::env::var_os("NODEVICE_SELECT").is_none() {
        // SAFETY: this is called first of all, so no other thread reads the environment.
        unsafe { std::env::set_var("NODEVICE_SELECT", "1") };
    }
}

/// Why a command failed: what, where and how to mend it.
#[derive(Debug)]
struct Failure(String);

impl<E: std::error::Error> From<E> for Failure {
    fn from(error: E) -> Self {
        Self(error.to_string())
    }
}

/// Prints one line on standard error; names of files and drivers' texts must not make it two, nor change the terminal.
fn warn(message: &str) {
    let message = message.replace(char::is_control, " ");
    // There is nowhere left to complain if this fails.
    let _ = writeln!(std::io::stderr(), "surfine: {message}");
}

/// Prints on standard output. A reader that has seen enough (`| head`) is no failure.
fn print(text: &str) -> Result<(), Failure> {
    let mut out = std::io::stdout().lock();
    match out.write_all(text.as_bytes()).and_then(|()| out.flush()) {
        Err(e) if e.kind() != ErrorKind::BrokenPipe => {
            Err(Failure(format!("standard output cannot be written: {e}: check where it leads")))
        }
        _ => Ok(()),
    }
}

/// Prints what `--json` asks for.
fn print_json(value: &impl Serialize) -> Result<(), Failure> {
    print(&format!("{}\n", serde_json::to_string_pretty(value)?))
}
