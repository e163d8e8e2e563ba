//! One device for all tests, single kernels on it, and the comparator.

use crate::clouds::{describe, small, small_outlined, variants};
use crate::tolerance::{EXACT, Tolerance};
use std::collections::HashMap;
use std::sync::{LazyLock, Mutex, MutexGuard, OnceLock};
use surfine::curves::table;
use surfine::records::{LEVEL_BITS, Params, Point};
use surfine::shaders::SHADERS;
use surfine::testing::{Buffer, Commands, Uniforms, constants, read};
use surfine::{Boundary, Gpu, Kernel, Mode, RefineParams, Refiner};
use surfine_features::{Features, Records};
use surfine_points::{Grid, PointSet};
use surfine_reference::boundary::boundary;
use surfine_reference::commit::commit;
use surfine_reference::insertion::Order;
use surfine_reference::neighborhood::neighborhood;
use surfine_reference::{Level, LevelState, point_grid, run_level};

/// The device with everything that tests share.
pub(crate) struct Device {
    pub refiner: Refiner,
    uniforms: Uniforms,
    /// Kernels compiled so far, by name and the values of the constants.
    kernels: HashMap<(String, Vec<bool>), Kernel>,
}

/// The shared device. Tests take turns on it: they measure nothing, and software drivers use all cores anyway.
pub(crate) fn device() -> MutexGuard<'static, Device> {
    static DEVICE: OnceLock<Mutex<Device>> = OnceLock::new();
    let open = || {
        let refiner =
            Refiner::new(None).unwrap_or_else(|e| panic!("conformance needs a GPU adapter: {e}"));
        let info = refiner.gpu().device.adapter_info();
        println!(
            "{} {} {}, {:?} mode",
            info.name,
            info.driver,
            info.driver_info,
            refiner.gpu().mode
        );
        let uniforms = Uniforms::new(refiner.gpu());
        Mutex::new(Device { refiner, uniforms, kernels: HashMap::new() })
    };
    // A test that failed with the device in hand has left it usable.
    DEVICE.get_or_init(open).lock().unwrap_or_else(std::sync::PoisonError::into_inner)
}

impl Device {
    pub(crate) fn gpu(&self) -> &Gpu {
        self.refiner.gpu()
    }

    /// Whether results must be those of the reference bit for bit.
    pub(crate) fn is_exact(&self) -> bool {
        let software =
            self.gpu().device.adapter_info().device_type == surfine::wgpu::DeviceType::Cpu;
        self.gpu().mode == Mode::Exact && software
    }

    /// The tolerance that applies here.
    pub(crate) fn allows(&self, tolerance: Tolerance) -> Tolerance {
        if self.is_exact() { EXACT } else { tolerance }
    }

    /// A buffer with `data`.
    pub(crate) fn buffer<T: bytemuck::Pod>(&self, label: &'static str, data: &[T]) -> Buffer {
        Buffer::with_data(self.gpu(), label, data).expect("test clouds fit every device")
    }

    /// A buffer for `count` values, zeroed, with guard words behind them.
    pub(crate) fn output<T: bytemuck::Pod>(&self, label: &'static str, count: usize) -> Buffer {
        let bytes = vec![0u8; count * size_of::<T>()];
        let guarded = [bytes, vec![GUARD; GUARD_BYTES]].concat();
        Buffer::with_data(self.gpu(), label, &guarded).expect("test clouds fit every device")
    }

    /// Reads the values of an [`Device::output`] and checks that nothing was written behind them.
    pub(crate) fn read<T: bytemuck::Pod>(&self, buffer: &Buffer, count: usize) -> Vec<T> {
        let used = count * size_of::<T>();
        let bytes: Vec<u8> =
            read(self.gpu(), buffer.raw(), used + GUARD_BYTES).expect("the device is alive");
        let guards = &bytes[used..];
        assert!(guards.iter().all(|&b| b == GUARD), "a kernel wrote behind its buffer");
        bytemuck::pod_collect_to_vec(&bytes[..used])
    }

    /// Runs one kernel once.
    pub(crate) fn run(&mut self, run: Run<'_>, buffers: &[&Buffer]) {
        let constants = constants(run.refine, run.params.records > 0);
        let key = (run.kernel.to_owned(), constants.iter().map(|c| c.1 == 1.0).collect());
        let gpu = self.refiner.gpu();
        let kernel = self.kernels.entry(key).or_insert_with(|| {
            let shader = SHADERS.iter().find(|s| s.name == run.kernel).expect("it is in the table");
            Kernel::new(gpu, shader, &constants).expect("the kernel compiles")
        });
        self.uniforms.set(gpu, &run.params);
        let mut commands = Commands::new(gpu, &self.uniforms);
        commands.run(kernel, buffers, run.words, run.invocations as u32);
        commands.finish().expect("the kernel runs");
    }
}

/// One refinement step as the reference runs it: the inputs and the answers of every kernel.
pub(crate) struct Step {
    pub name: String,
    pub level: Level,
    pub refine: RefineParams,
    pub state: LevelState,
}

/// The first and the second step of every small cloud in every variant. The second one splits curves.
pub(crate) fn steps() -> &'static [Step] {
    static STEPS: LazyLock<Vec<Step>> = LazyLock::new(all_steps);
    &STEPS
}

fn all_steps() -> Vec<Step> {
    let mut steps = Vec::new();
    let outlined = small_outlined();
    let names: Vec<String> = outlined.iter().map(|cloud| cloud.name.clone()).collect();
    for cloud in small().into_iter().chain(outlined) {
        for refine in variants() {
            let mut level = first_level(&cloud.points, &refine);
            for number in 1..=2 {
                level.begin_step(refine.rules);
                let has_curves = level.curves.is_some();
                assert!(has_curves || !names.contains(&cloud.name), "{} has no curves", cloud.name);
                let splits = has_curves && Features::splits_at(number, refine.rules);
                assert_eq!(!level.curve_points.is_empty(), splits, "{} {number}", cloud.name);
                let (state, _) = run_level(&level, &refine, Order::Together, &mut |_| ());
                let name = format!("{} {} step {number}", cloud.name, describe(&refine));
                let mut next = level.clone();
                commit(&mut next, &state, &refine);
                steps.push(Step { name, level, refine: refine.clone(), state });
                level = next;
            }
        }
    }
    steps
}

/// The input with its creases and boundaries.
pub(crate) fn first_level(points: &PointSet, refine: &RefineParams) -> Level {
    let mut level = Level::new(&Records::split(points).expect("the cloud is sound"));
    if refine.boundary != Boundary::None {
        let rings = neighborhood(&level, &point_grid(&level), refine);
        boundary(&mut level, &rings, points, refine);
    }
    level
}

impl Step {
    /// Creases and boundaries, if there are any.
    pub(crate) fn features(&self) -> Option<&Features> {
        self.level.curves.as_ref().map(|curves| &curves.features)
    }

    /// The table of creases and boundaries.
    pub(crate) fn curves(&self) -> Vec<u32> {
        table(self.features().unwrap_or(&Features::default()), &self.level.curve_points)
    }

    /// The candidates by cell, with the table of curves behind the last slot's place.
    pub(crate) fn candidate_grid_words(&self) -> Vec<u32> {
        let grid = &self.state.candidate_grid;
        let mut words = grid_words(grid);
        words.resize(grid.starts.len() + self.state.candidates.len(), 0);
        [words, self.curves()].concat()
    }

    /// The states of the slots before the first class.
    pub(crate) fn initial_states(&self) -> Vec<u32> {
        let c = &self.state.candidates;
        let state = |slot: usize| match (slot >= c.first_on_curve, c.exists(slot)) {
            (true, _) => ON_CURVE,
            (false, true) => FREE,
            (false, false) => u32::MAX,
        };
        (0..c.len()).map(state).collect()
    }

    /// The uniform of this step, with capacities that suffice.
    pub(crate) fn params(&self) -> Params {
        Params {
            points: self.level.len() as u32,
            slots: self.state.candidates.len() as u32,
            fan_slots: self.state.rings.len() as u32,
            records: self.features().map_or(0, |features| features.old as u32),
            level: self.level.step + 1,
            arena_words: ARENA_WORDS as u32,
            ring_entries: self.state.rings.len() as u32,
            conflict_entries: CONFLICT_ENTRIES as u32,
            ..Params::new(&self.refine).with_grid(&self.state.grid.shape)
        }
    }

    /// A run of one of this step's kernels.
    pub(crate) fn run<'a>(
        &'a self,
        kernel: &'a str,
        words: [u32; 4],
        invocations: usize,
    ) -> Run<'a> {
        Run { kernel, refine: &self.refine, params: self.params(), words, invocations }
    }

    pub(crate) fn points(&self) -> Vec<Point> {
        let l = &self.level;
        let point = |i: usize| Point {
            position: l.positions[i].to_array(),
            radius: l.radii[i],
            normal: l.normals[i].to_array(),
            // No record is the largest index.
            level: l.seen(i).record.wrapping_add(1) << LEVEL_BITS,
        };
        (0..l.len()).map(point).collect()
    }

    pub(crate) fn ring_entries(&self) -> Vec<[u32; 2]> {
        self.state.rings.entries.iter().map(|e| [e.id, e.angle.to_bits()]).collect()
    }

    pub(crate) fn candidate_positions(&self) -> Vec<[f32; 4]> {
        let c = &self.state.candidates;
        (0..c.rho.len()).map(|i| c.positions[i].extend(c.rho[i]).to_array()).collect()
    }

    pub(crate) fn candidate_normals(&self) -> Vec<[f32; 4]> {
        let c = &self.state.candidates;
        // New points on curves have no owner.
        let near = |i: usize| c.near.get(c.owners[i] as usize).copied().unwrap_or(0.0);
        (0..c.rho.len()).map(|i| c.normals[i].extend(near(i)).to_array()).collect()
    }
}

/// The cells of a grid as the kernels have them: starts, then entries.
pub(crate) fn grid_words(grid: &Grid) -> Vec<u32> {
    [grid.starts.as_slice(), &grid.items].concat()
}

/// States of a slot, as `shaders/shared/records.wgsl` has them: a candidate that no class has tried, a new point on a curve,
/// and a candidate that was tried in vain. What a class inserts has a state of 2 on.
pub(crate) const FREE: u32 = 0;
pub(crate) const ON_CURVE: u32 = 1;
pub(crate) const USED: u32 = u32::MAX - 1;

/// Capacities that every small cloud keeps.
pub(crate) const ARENA_WORDS: usize = 1 << 20;
pub(crate) const CONFLICT_ENTRIES: usize = 1 << 18;

/// What a kernel is run with, besides its buffers.
#[derive(Clone, Copy)]
pub(crate) struct Run<'a> {
    pub kernel: &'a str,
    pub refine: &'a RefineParams,
    pub params: Params,
    pub words: [u32; 4],
    pub invocations: usize,
}

const GUARD: u8 = 0xa5;
/// Four guard bytes.
pub(crate) const GUARD_WORD: u32 = 0xa5a5_a5a5;
const GUARD_BYTES: usize = 64;

/// Compares floats: equal lengths, all finite, and within the tolerance times `scale`.
///
/// # Errors
/// The first difference: where, both values, and how far apart they are.
pub(crate) fn compare(
    what: &str,
    expected: &[f32],
    found: &[f32],
    tolerance: Tolerance,
    scale: f32,
) -> Result<(), String> {
    if expected.len() != found.len() {
        return Err(format!("{what}: {} values instead of {}", found.len(), expected.len()));
    }
    for (i, (&e, &f)) in expected.iter().zip(found).enumerate() {
        if !f.is_finite() {
            return Err(format!("{what}[{i}] is {f}"));
        }
        let close = tolerance.relative > 0.0 && (e - f).abs() <= tolerance.relative * scale;
        if e.to_bits() != f.to_bits() && !close {
            let steps = i64::from(e.to_bits()) - i64::from(f.to_bits());
            let limit = format!("{} allowed ({})", tolerance.relative * scale, tolerance.reason);
            return Err(format!(
                "{what}[{i}] is {f:e} instead of {e:e}, {steps} steps apart; {limit}"
            ));
        }
    }
    Ok(())
}

/// Compares anything else: equal lengths and equal values.
///
/// # Errors
/// The first difference.
pub(crate) fn compare_equal<T: PartialEq + std::fmt::Debug>(
    what: &str,
    expected: &[T],
    found: &[T],
) -> Result<(), String> {
    if expected.len() != found.len() {
        return Err(format!("{what}: {} values instead of {}", found.len(), expected.len()));
    }
    match expected.iter().zip(found).position(|(e, f)| e != f) {
        Some(i) => Err(format!("{what}[{i}] is {:?} instead of {:?}", found[i], expected[i])),
        None => Ok(()),
    }
}

/// Panics with the text of a failed comparison.
pub(crate) fn must(result: Result<(), String>) {
    if let Err(difference) = result {
        panic!("{difference}");
    }
}
