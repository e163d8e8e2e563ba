//! The program as its users run it: files in, files out, exit codes and messages.

mod bench;
mod dry_run;
mod evaluate;
mod folder;
mod holes;
mod refine;
mod render;
