//! Runs that go in slices, beside the caller's own work on the device.

use crate::pace::Pace;
use crate::refiner::{GpuRefined, Refiner};
use crate::uniforms::lock;
use crate::{Error, Gpu};
use std::fmt::{Debug, Formatter};
use std::ops::{Deref, DerefMut};
use std::pin::Pin;
use std::sync::{Arc, Mutex};
use std::task::{Context, Poll, Waker};
use std::time::Duration;
use surfine_points::{PointSet, Progress, RefineParams};

/// A run that goes in slices: [`Refiner::begin`] makes it, [`Slices::advance`] drives it, and [`Slices::into_refiner`]
/// gives the refiner back, before the end too. It borrows nothing and is `Send`, so that it can be kept from frame to
/// frame.
///
/// ```no_run
/// use std::time::Duration;
/// use surfine::{PointSet, RefineParams, Refiner};
/// # fn draw_a_frame() {}
/// # fn main() -> Result<(), surfine::Error> {
/// # let points = PointSet::default();
/// # let refiner = Refiner::new(None)?;
/// let mut run = refiner.begin(points, RefineParams::default());
/// let refined = loop {
///     // Once a frame: about 4 ms of the device's time.
///     if let Some(refined) = run.advance(Duration::from_millis(4))? {
///         break refined;
///     }
///     draw_a_frame();
/// };
/// let refiner = run.into_refiner();
/// # Ok(())
/// # }
/// ```
pub struct Slices {
    gpu: Gpu,
    pace: Arc<Mutex<Pace>>,
    progress: Arc<Mutex<Option<Progress>>>,
    /// None once it has ended.
    run: Option<Run>,
    /// Where the refiner comes back to.
    home: Arc<Mutex<Option<Refiner>>>,
}

type Run = Pin<Box<dyn Future<Output = Result<GpuRefined, Error>> + Send>>;

impl Refiner {
    /// Begins a run that goes in slices. It gives the bytes of [`Refiner::refine_on_device`], however it is sliced.
    ///
    /// Nothing is done before the first [`Slices::advance`], which also reports unfit points and parameters.
    pub fn begin(self, points: impl Into<Arc<PointSet>>, params: RefineParams) -> Slices {
        let (gpu, pace) = (self.gpu().clone(), Arc::clone(&self.pace));
        let (home, progress) = (Arc::default(), Arc::<Mutex<_>>::default());
        let mut lent = Lent { refiner: Some(self), home: Arc::clone(&home) };
        lent.uniforms.begin_pace(&gpu, Arc::clone(&pace));
        let (points, told) = (points.into(), Arc::clone(&progress));
        let run = async move {
            lent.run(&points, &params, move |progress| *lock(&told) = Some(progress)).await
        };
        Slices { gpu, pace, progress, run: Some(Box::pin(run)), home }
    }
}

impl Slices {
    /// Goes on: submits work that takes the device about as long as the budget, and returns without waiting for it.
    /// While the work of an earlier call still runs, nothing is submitted. The result comes when all work is done.
    ///
    /// How long kernels take is learned from slice to slice, beginning with small parts; the refiner remembers it for
    /// later runs. Devices with `wgpu::Features::TIMESTAMP_QUERY` tell it. On others a slice counts until the call, or
    /// another poll of the device, that finds it finished: there slices stay small unless calls follow each other
    /// faster than the budget.
    ///
    /// Some work is never cut:
    ///
    /// * the host's part: the first call checks, orders and uploads the points, 0.15 to 0.3 µs for each (it can be made
    ///   on another thread), and each step lays out creases and boundaries in one call;
    /// * buffers that grow, which the driver fills with zeros;
    /// * kernels that [`Refiner::prepare`] or [`Refiner::prepare_curves`] did not compile, and those for buffers longer
    ///   than a binding: they are compiled in the call that needs them;
    /// * the rounds of the selection that few candidates wait for;
    /// * with `simplified` the contested candidates, at most about a third; by the paper's loop a round of the
    ///   colouring, a 32nd of the points.
    ///
    /// # Errors
    /// As [`Refiner::refine`]. The run has ended then.
    ///
    /// # Panics
    /// The run had ended before the call.
    pub fn advance(&mut self, budget: Duration) -> Result<Option<GpuRefined>, Error> {
        let run = self.run.as_mut().expect("the run has not ended");
        lock(&self.pace).refill(budget);
        let mut context = Context::from_waker(Waker::noop());
        // Only this call's errors are caught: what the caller does between the calls is his.
        let polled = self.gpu.guarded(|| match run.as_mut().poll(&mut context) {
            Poll::Ready(result) => result.map(Some),
            Poll::Pending => Ok(None),
        });
        if !matches!(polled, Ok(None)) {
            self.run = None;
        }
        if polled.is_err() {
            lock(&self.home).iter_mut().for_each(Refiner::renew);
        }
        polled
    }

    /// The stage that runs, once one has begun.
    pub fn progress(&self) -> Option<Progress> {
        *lock(&self.progress)
    }

    /// Ends the run, if it has not ended, and gives the refiner back, fit for the next one. What was submitted still
    /// runs.
    pub fn into_refiner(self) -> Refiner {
        drop(self.run);
        lock(&self.home).take().expect("the end of a run brings the refiner home")
    }
}

impl Debug for Slices {
    fn fmt(&self, f: &mut Formatter<'_>) -> std::fmt::Result {
        let has_ended = self.run.is_none();
        let mut fields = f.debug_struct("Slices");
        fields.field("progress", &self.progress()).field("has_ended", &has_ended).finish()
    }
}

/// A refiner that goes home when its run ends, is dropped or panics.
struct Lent {
    refiner: Option<Refiner>,
    home: Arc<Mutex<Option<Refiner>>>,
}

impl Deref for Lent {
    type Target = Refiner;

    fn deref(&self) -> &Refiner {
        self.refiner.as_ref().expect("it goes home last")
    }
}

impl DerefMut for Lent {
    fn deref_mut(&mut self) -> &mut Refiner {
        self.refiner.as_mut().expect("it goes home last")
    }
}

impl Drop for Lent {
    fn drop(&mut self) {
        let mut refiner = self.refiner.take();
        if let Some(Refiner { uniforms, .. }) = &mut refiner {
            uniforms.end_pace();
        }
        *lock(&self.home) = refiner;
    }
}
