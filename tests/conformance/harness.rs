//! One device for all tests, single kernels on it, and the comparator.

use crate::clouds::{describe, small, small_outlined, variants};
use crate::tolerance::{EXACT, Tolerance};
use naga::{Expression, Literal};
use std::collections::HashMap;
use std::sync::{LazyLock, Mutex, MutexGuard, OnceLock};
use surfine::testing::Kernel;
use surfine::testing::curves::{Curves, Table, table};
use surfine::testing::records::{ARENA_BLOCK, Candidate, Counters, Fan, LEVEL_BITS, Params, Point};
use surfine::testing::shaders::{SHADERS, Shader};
use surfine::testing::{Buffer, Commands, Uniforms, constants, read};
use surfine::{Boundary, Gpu, Mode, RefineParams, Refiner, Vec3};
use surfine_features::{Features, Records};
use surfine_points::{Grid, PointSet};
use surfine_reference::boundary::boundary;
use surfine_reference::commit::commit;
use surfine_reference::conflicts::Conflicts;
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

    /// Zeroed counters.
    pub(crate) fn counters(&self) -> Buffer {
        self.output::<u32>("counters", size_of::<Counters>() / 4)
    }

    /// Reads counters and checks that no loop was cut and no arena too small.
    pub(crate) fn read_counters(&self, buffer: &Buffer, name: &str) -> Counters {
        let counters = self.read::<Counters>(buffer, 1)[0];
        assert_eq!(counters.cut_loops, 0, "{name}");
        let words = (ARENA_BLOCK * counters.arena_peak) as usize;
        assert!(words <= ARENA_WORDS, "{name}: the arena is too small");
        counters
    }

    /// A buffer with `data` that kernels change, with guard words behind it.
    pub(crate) fn guarded<T: bytemuck::Pod>(&self, label: &'static str, data: &[T]) -> Buffer {
        let guarded = [bytemuck::cast_slice(data), &[GUARD; GUARD_BYTES]].concat();
        Buffer::with_data(self.gpu(), label, &guarded).expect("test clouds fit every device")
    }

    /// Runs one kernel once.
    pub(crate) fn run(&mut self, run: Run<'_>, buffers: &[&Buffer]) {
        let constants = constants(run.refine, run.curves);
        let key = (run.kernel.to_owned(), constants.iter().map(|c| c.1 == 1.0).collect());
        let gpu = self.refiner.gpu();
        let kernel = self.kernels.entry(key).or_insert_with(|| {
            Kernel::new(gpu, shader(run.kernel), &constants).expect("the kernel compiles")
        });
        self.uniforms.set(gpu, &run.params);
        let mut commands = Commands::new(gpu, &self.uniforms);
        let finished = pollster::block_on(async {
            commands.run(kernel, buffers, run.words, run.invocations as u32).await;
            commands.finish().await
        });
        finished.expect("the kernel runs");
    }
}

fn shader(kernel: &str) -> &'static Shader {
    SHADERS.iter().find(|s| s.name == kernel).expect("it is in the table")
}

/// A constant of a kernel, or of a file that it shares.
pub(crate) fn constant(kernel: &str, name: &str) -> u32 {
    let module = naga::front::wgsl::parse_str(&shader(kernel).source()).expect("it is valid");
    let named = |c: &naga::Constant| c.name.as_deref() == Some(name);
    let found = module.constants.iter().map(|(_, c)| c).find(|c| named(c));
    let found = found.unwrap_or_else(|| panic!("{kernel} has no constant {name}"));
    match module.global_expressions[found.init] {
        Expression::Literal(Literal::U32(value)) => value,
        ref other => panic!("{name} is {other:?}"),
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

/// Those that select new points among all candidates, or those that do around one point after the other.
pub(crate) fn steps_with(largest_first: bool) -> impl Iterator<Item = &'static Step> {
    steps().iter().filter(move |step| step.refine.rules.largest_first == largest_first)
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
                commit(&mut next, &state);
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
        let words = self.table().words;
        // No buffer is empty.
        if words.is_empty() { vec![0] } else { words }
    }

    fn table(&self) -> Table {
        table(self.features().unwrap_or(&Features::default()), &self.level.curve_points)
    }

    /// The uniform of this step, with capacities that suffice.
    pub(crate) fn params(&self) -> Params {
        let state = &self.state;
        Params {
            points: self.level.len() as u32,
            slots: state.rings.len() as u32,
            triangles: state.candidates.first_on_curve as u32,
            candidates: state.candidates.len() as u32,
            level: self.level.step + 1,
            records: self.features().map_or(0, |features| features.old as u32),
            arena_words: ARENA_WORDS as u32,
            ring_entries: state.rings.len() as u32,
            around_entries: (state.conflicts.around.items.len()
                + 2 * state.conflicts.before.items.len()) as u32,
            mirror_links: MIRROR_LINKS as u32,
            ..Params::new(&self.refine).with_grid(&state.grid.shape).with_curves(&self.table())
        }
    }

    /// A run of one of this step's kernels.
    pub(crate) fn run<'a>(
        &'a self,
        kernel: &'a str,
        words: [u32; 4],
        invocations: usize,
    ) -> Run<'a> {
        let curves = self.features().map_or(Curves::None, Curves::of);
        Run { kernel, refine: &self.refine, curves, params: self.params(), words, invocations }
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
        self.state.rings.lists.items.iter().map(|e| [e.id, e.angle.to_bits()]).collect()
    }

    /// The fans with the reference's lists, all of them left over by these kernels.
    pub(crate) fn fans(&self, left_over: u32) -> Vec<Fan> {
        let LevelState { rings, candidates, conflicts, .. } = &self.state;
        let (mut first, mut fans) = (0, Vec::new());
        for p in 0..self.level.len() {
            let slots = rings.slots(p);
            let around = conflicts.around.of(p).len() as u32;
            let before = conflicts_before(conflicts, p).len() as u32;
            fans.push(Fan {
                slots: [slots.start as u32, slots.len() as u32],
                near: candidates.near[p],
                left_over,
                around: [first, around],
                // None is mirrored.
                conflicts: [before, before],
            });
            first += around + before;
        }
        fans
    }

    /// The lists of [`Step::fans`].
    pub(crate) fn around(&self) -> Vec<u32> {
        let conflicts = &self.state.conflicts;
        let of = |p: usize| [conflicts.around.of(p), conflicts_before(conflicts, p)].concat();
        (0..self.level.len()).flat_map(of).collect()
    }

    /// The candidates before the first class.
    pub(crate) fn candidates(&self) -> Vec<Candidate> {
        let c = &self.state.candidates;
        let candidate = |i: usize| Candidate {
            place: c.positions[i].extend(c.rho[i]).to_array(),
            normal: c.normals[i].to_array(),
            state: if i < c.first_on_curve { FREE } else { ON_CURVE },
            corners: c.corners[i],
            size: c.sizes[i],
        };
        (0..c.len()).map(candidate).collect()
    }

    /// The candidates by cell.
    pub(crate) fn candidate_grid(&self) -> &Grid {
        self.state.candidate_grid.as_ref().expect("the variant sorts its candidates into cells")
    }

    /// The first of the candidates that belong to each point, and one more: these are at home in the first fan that has
    /// them.
    pub(crate) fn first_candidates(&self) -> Vec<u32> {
        let c = &self.state.candidates;
        let has =
            |p: u32, i: usize| c.of_slot[self.state.rings.slots(p as usize)].contains(&(i as u32));
        let mut firsts = vec![0; self.level.len() + 1];
        for (i, corners) in c.corners[..c.first_on_curve].iter().enumerate() {
            let home = corners.iter().find(|&&p| has(p, i)).expect("it is in a fan");
            firsts[*home as usize + 1] += 1;
        }
        for p in 0..self.level.len() {
            firsts[p + 1] += firsts[p];
        }
        firsts
    }

    /// The candidates as all classes leave them.
    pub(crate) fn decided(&self) -> Vec<Candidate> {
        let states = &self.state.insertion.states;
        let decide = |(c, &state): (Candidate, &u32)| Candidate { state, ..c };
        self.candidates().into_iter().zip(states).map(decide).collect()
    }
}

/// The conflicts of a point with those that choose before it; a selection among all candidates has none.
fn conflicts_before(conflicts: &Conflicts, p: usize) -> &[u32] {
    if conflicts.before.is_empty() { &[] } else { conflicts.before.of(p) }
}

/// A grid as the kernels have it: where each cell begins, and bits of the positions of the entries with their indices.
pub(crate) fn grid_words(grid: &Grid) -> (Vec<u32>, Vec<[u32; 4]>) {
    let place = |(&id, x): (&u32, &Vec3)| {
        let [x, y, z] = x.to_array().map(f32::to_bits);
        [x, y, z, id]
    };
    (grid.starts.clone(), grid.items.iter().zip(&grid.places).map(place).collect())
}

// States of a candidate, as `shaders/shared/records.wgsl` has them.
pub(crate) const FREE: u32 = u32::MAX;
pub(crate) const ON_CURVE: u32 = 0;
pub(crate) const INSERTED: u32 = 1;
pub(crate) const WAITING: u32 = u32::MAX - 1;

// Bits of the kernels that leave points over.
pub(crate) const NEIGHBORHOOD: u32 = 1;
pub(crate) const CONFLICTS: u32 = 2;
pub(crate) const INSERTION: u32 = 4;
pub(crate) const NEXT_RING: u32 = 8;

/// Capacities that every small cloud keeps.
pub(crate) const ARENA_WORDS: usize = 1 << 21;
pub(crate) const MIRROR_LINKS: usize = 1 << 16;

/// What a kernel is run with, besides its buffers.
#[derive(Clone, Copy)]
pub(crate) struct Run<'a> {
    pub kernel: &'a str,
    pub refine: &'a RefineParams,
    pub curves: Curves,
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

#[test]
fn states_and_bits_are_those_of_the_kernels() {
    for (name, value) in [
        ("FREE", FREE),
        ("ON_CURVE", ON_CURVE),
        ("INSERTED", INSERTED),
        ("WAITING", WAITING),
        ("NEIGHBORHOOD", NEIGHBORHOOD),
        ("CONFLICTS", CONFLICTS),
        ("INSERTION", INSERTION),
        ("NEXT_RING", NEXT_RING),
    ] {
        assert_eq!(constant("selection", name), value, "{name} in records.wgsl");
    }
}
