//! Numbers of many points side by side, so that loops over them run in vector registers.
//!
//! The loops call the formulas of single points. The compiler makes vectors of them where nothing in the loop
//! branches for good, where columns have a length that it knows, and where what is written can't be what is read:
//! so each such loop is a function of its own ([`vectorized`]). Operations stay the same for each point, and so do
//! the bytes: nothing is fused.

use glam::Vec3;

/// Entries of a column.
pub(crate) const BLOCK: usize = 32;
/// Columns of other lengths are filled up to multiples of this.
pub(crate) const LANES: usize = 8;

/// A column of numbers.
pub(crate) type Column = [f32; BLOCK];

/// Vectors, with a column for each axis.
#[derive(Clone, Copy)]
pub(crate) struct Vectors {
    x: Column,
    y: Column,
    z: Column,
}

impl Vectors {
    pub(crate) const ZERO: Self = Self { x: [0.0; BLOCK], y: [0.0; BLOCK], z: [0.0; BLOCK] };

    #[inline(always)]
    pub(crate) fn get(&self, i: usize) -> Vec3 {
        Vec3::new(self.x[i], self.y[i], self.z[i])
    }

    #[inline(always)]
    pub(crate) fn set(&mut self, i: usize, v: Vec3) {
        (self.x[i], self.y[i], self.z[i]) = (v.x, v.y, v.z);
    }
}

/// Defines functions whose loops run in vector registers: in those of AVX2, eight numbers wide, where the processor has
/// them, else in those that every processor of the target has.
macro_rules! vectorized {
    ($(
        $(#[$attribute:meta])*
        $visible:vis fn $name:ident $([$($generics:tt)*] [$($parameter:ident)*])? (
            $($argument:ident: $type:ty),* $(,)?
        ) $body:block
    )*) => {$(
        $(#[$attribute])*
        $visible fn $name$(<$($generics)*>)?($($argument: $type),*) {
            #[inline(always)]
            fn plain$(<$($generics)*>)?($($argument: $type),*) $body

            #[cfg(target_arch = "x86_64")]
            #[target_feature(enable = "avx2")]
            fn wide$(<$($generics)*>)?($($argument: $type),*) {
                plain$(::<$($parameter),*>)?($($argument),*);
            }

            #[cfg(target_arch = "x86_64")]
            if std::arch::is_x86_feature_detected!("avx2") {
                // SAFETY: the processor has AVX2.
                unsafe { wide$(::<$($parameter),*>)?($($argument),*) };
                return;
            }
            plain$(::<$($parameter),*>)?($($argument),*);
        }
    )*};
}
pub(crate) use vectorized;
