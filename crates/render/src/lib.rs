//! Draws clouds of oriented points as splats.
