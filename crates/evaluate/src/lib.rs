//! Measures how well a cloud of oriented points shows a surface.
