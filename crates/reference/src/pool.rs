//! Scratch memory that threads hand on to each other.

use std::ops::{Deref, DerefMut};
use std::sync::{Mutex, PoisonError};

/// What threads used and will use again: as many as were needed at once.
#[derive(Default)]
pub(crate) struct Pool<T>(Mutex<Vec<T>>);

impl<T: Default> Pool<T> {
    /// Takes one that was used before, or a new one.
    pub(crate) fn lend(&self) -> Lent<'_, T> {
        let used = self.0.lock().unwrap_or_else(PoisonError::into_inner).pop();
        Lent { value: used.unwrap_or_default(), pool: self }
    }
}

/// Goes back to its pool when it is dropped.
pub(crate) struct Lent<'a, T: Default> {
    value: T,
    pool: &'a Pool<T>,
}

impl<T: Default> Deref for Lent<'_, T> {
    type Target = T;

    fn deref(&self) -> &T {
        &self.value
    }
}

impl<T: Default> DerefMut for Lent<'_, T> {
    fn deref_mut(&mut self) -> &mut T {
        &mut self.value
    }
}

impl<T: Default> Drop for Lent<'_, T> {
    fn drop(&mut self) {
        let value = std::mem::take(&mut self.value);
        self.pool.0.lock().unwrap_or_else(PoisonError::into_inner).push(value);
    }
}
