//! Loops and fills on generated clouds, and on the models of the paper where their files are.

mod clouds;
mod filled;
mod found;
mod models;
