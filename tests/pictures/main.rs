//! The painters of `surfine_render`, held to pictures that were looked at, to exact geometry and to each other.
//!
//! Every scene is drawn on the GPU and on the CPU. Without a GPU adapter the tests fail: install one (on Debian
//! `mesa-vulkan-drivers`); `tests/run.sh` does.
//!
//! `UPDATE_GOLDEN=1 cargo test --test pictures` rewrites the pictures in `tests/golden`, with the CPU. Look at them
//! before they are committed. A picture that differs is written to the folder that the message names, beside a picture
//! of the difference. `-- --nocapture` shows how far apart all pictures are.

mod camera;
mod comparator;
mod edges;
mod files;
mod geometry;
mod golden;
mod painters;
mod scenes;
