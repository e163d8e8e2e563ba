//! Every measure on inputs that a few lines of brute force, or a hand, can check.
//!
//! Numbers beside a bound were measured with this code.

mod by_hand;
mod colors;
mod creases;
mod planted;
mod repeatable;
mod scenes;
mod survival;
mod twice;
mod unfit;
