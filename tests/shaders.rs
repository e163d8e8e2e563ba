//! The kernels as text, without a GPU: they are valid, keep to what drivers agree on, and match the host's side.

use naga::valid::{Capabilities, FunctionInfo, ModuleInfo, ValidationFlags, Validator};
use naga::{
    AddressSpace, BinaryOperator, Expression, Function, Handle, Literal, MathFunction, Module,
    ScalarKind, TypeInner,
};
use std::any::type_name_of_val;
use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::mem::offset_of;
use std::path::{Path, PathBuf};
use surfine::testing::constants;
use surfine::testing::curves::Curves;
use surfine::testing::shaders::{SHADERS, Shader};
use surfine::testing::{exact_spirv, records};
use surfine::{RefineParams, Rules};

/// The constants that the engine gives to every kernel that declares them.
fn known_constants() -> Vec<&'static str> {
    constants(&RefineParams::default(), Curves::None).into_iter().map(|(name, _)| name).collect()
}

/// A kernel's module, as the engine parses it.
fn parse(shader: &Shader) -> Module {
    parse_text(shader.name, &shader.source())
}

fn parse_text(name: &str, source: &str) -> Module {
    naga::front::wgsl::parse_str(source)
        .unwrap_or_else(|e| panic!("{}", e.emit_to_string_with_path(source, name)))
}

fn validate(name: &str, module: &Module) -> ModuleInfo {
    // No capabilities: nothing that an adapter may lack.
    Validator::new(ValidationFlags::all(), Capabilities::empty())
        .validate(module)
        .unwrap_or_else(|e| panic!("{name}: {e:?}"))
}

/// The parts of the module's `override`s that have a name.
fn overrides(module: &Module) -> Vec<&str> {
    module.overrides.iter().filter_map(|(_, o)| o.name.as_deref()).collect()
}

/// The kernel in SPIR-V with all its constants 0, then 1.
fn exact_variants(shader: &Shader) -> [Vec<u32>; 2] {
    let module = parse(shader);
    [0.0, 1.0].map(|value| {
        let constants: Vec<_> = overrides(&module).into_iter().map(|name| (name, value)).collect();
        exact_spirv(shader.entry, &module, &constants)
            .unwrap_or_else(|e| panic!("{} = {value}: {e}", shader.name))
    })
}

/// A WGSL folder's files by stem.
fn files(folder: &str) -> BTreeMap<String, String> {
    let folder = root().join(folder);
    let entries = fs::read_dir(&folder).unwrap().map(|e| e.unwrap().path());
    let stem = |path: &Path| path.file_stem().unwrap().to_str().unwrap().to_owned();
    entries
        .filter(|path| path.extension().is_some_and(|e| e == "wgsl"))
        .map(|path| (stem(&path), fs::read_to_string(&path).unwrap()))
        .collect()
}

fn root() -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR"))
}

#[test]
fn every_file_is_a_kernel_or_shared_by_kernels() {
    let kernels = files("shaders");
    let names: BTreeSet<&str> = SHADERS.iter().map(|s| s.name).collect();
    assert_eq!(names.len(), SHADERS.len(), "a kernel is listed twice");
    let entries: BTreeSet<&str> = SHADERS.iter().map(|s| s.entry).collect();
    assert_eq!(entries, kernels.keys().map(String::as_str).collect());
    for shader in SHADERS {
        assert!(shader.files[0] == kernels[shader.entry], "{} is another file", shader.name);
    }
    let used: BTreeSet<&str> = SHADERS.iter().flat_map(|s| &s.files[1..]).copied().collect();
    for (stem, text) in files("shaders/shared") {
        assert!(used.contains(text.as_str()), "no kernel uses shared/{stem}.wgsl");
    }
}

#[test]
fn kernels_are_valid() {
    for shader in SHADERS {
        validate(shader.name, &parse(shader));
    }
}

#[test]
fn shaders_of_pictures_are_valid() {
    for (name, text) in surfine_render::SHADERS {
        validate(name, &parse_text(name, text));
    }
}

#[test]
fn every_file_of_the_painter_is_used() {
    let files = files("shaders/render");
    assert!(files.len() >= surfine_render::SHADERS.len(), "{:?}", files.keys());
    for (stem, text) in files {
        let is_used = surfine_render::SHADERS.iter().any(|(_, all)| all.contains(&text));
        assert!(is_used, "no shader uses render/{stem}.wgsl");
    }
}

#[test]
fn entry_points_are_named_like_their_files() {
    for shader in SHADERS {
        let module = parse(shader);
        let [entry] = &module.entry_points[..] else {
            panic!("{}: {} entry points", shader.name, module.entry_points.len())
        };
        assert_eq!(entry.name, shader.entry);
        // `linear_index` has the same number in its text.
        assert_eq!(entry.workgroup_size, [64, 1, 1], "{}", shader.name);
        assert_eq!(surfine::testing::WORKGROUP_SIZE, 64);
    }
}

#[test]
fn bindings_are_without_gaps_and_few() {
    let mut most = 0;
    for shader in SHADERS {
        let module = parse(shader);
        let mut spaces = BTreeMap::new();
        for (_, variable) in module.global_variables.iter() {
            let Some(binding) = variable.binding else { continue };
            assert_eq!(binding.group, 0, "{}: {:?}", shader.name, variable.name);
            let other = spaces.insert(binding.binding, variable.space);
            assert_eq!(other, None, "{}: binding {} twice", shader.name, binding.binding);
        }
        let numbers: Vec<u32> = spaces.keys().copied().collect();
        assert_eq!(numbers, Vec::from_iter(0..numbers.len() as u32), "{}", shader.name);
        let uniforms = spaces.values().filter(|s| **s == AddressSpace::Uniform).count();
        assert_eq!(uniforms, 2, "{}: the step's and the dispatch's", shader.name);
        most = most.max(spaces.len() - uniforms);
    }
    // `KERNEL_BUFFERS` in crates/engine/src/gpu.rs: devices with fewer are refused, and what others have beyond that
    // is for windows of long buffers.
    assert_eq!(most, 10, "storage buffers of a kernel");
}

#[test]
fn constants_are_known_and_reach_the_code() {
    let mut declared = BTreeSet::new();
    for shader in SHADERS {
        let module = parse(shader);
        let names = overrides(&module);
        // The engine gives no other ones and leaves out those that a kernel does not declare.
        assert!(names.iter().all(|n| known_constants().contains(n)), "{}: {names:?}", shader.name);
        let [off, on] = exact_variants(shader);
        assert_eq!(off != on, !names.is_empty(), "{}: a constant changes nothing", shader.name);
        declared.extend(names.into_iter().map(str::to_owned));
    }
    assert_eq!(declared, known_constants().into_iter().map(str::to_owned).collect());
}

/// Words of the SPIR-V header.
const HEADER: usize = 5;
const OP_DECORATE: u32 = 71;
const NO_CONTRACTION: u32 = 42;

/// The instructions of a SPIR-V module: opcode and all words.
fn instructions(spirv: &[u32]) -> impl Iterator<Item = (u32, &[u32])> {
    let mut rest = &spirv[HEADER..];
    std::iter::from_fn(move || {
        let length = (*rest.first()? >> 16) as usize;
        assert!(length > 0, "an instruction without words");
        let (instruction, after) = rest.split_at(length);
        rest = after;
        Some((instruction[0] & 0xffff, instruction))
    })
}

fn is_no_contraction(opcode: u32, words: &[u32]) -> bool {
    opcode == OP_DECORATE && words[2] == NO_CONTRACTION
}

/// Results of float arithmetic: negation, + - * / and remainders, then products with vectors and matrices to `OpDot`.
fn float_results(spirv: &[u32]) -> BTreeSet<u32> {
    let is_float = |opcode| matches!(opcode, 127 | 129 | 131 | 133 | 136 | 140..=148);
    instructions(spirv).filter(|(opcode, _)| is_float(*opcode)).map(|(_, w)| w[2]).collect()
}

/// Float operations that a driver may reassociate.
fn contractible(spirv: &[u32]) -> Vec<u32> {
    let decorated: BTreeSet<u32> =
        instructions(spirv).filter(|(o, w)| is_no_contraction(*o, w)).map(|(_, w)| w[1]).collect();
    float_results(spirv).difference(&decorated).copied().collect()
}

#[test]
fn every_float_operation_is_exact() {
    for shader in SHADERS {
        for spirv in exact_variants(shader) {
            assert!(spirv.len() > HEADER, "{}: empty", shader.name);
            assert_eq!(contractible(&spirv), [], "{}: not decorated", shader.name);
        }
    }
}

#[test]
fn float_operations_are_found() {
    let source = "@group(0) @binding(0) var<storage, read_write> x: vec4<f32>;\n\
        @compute @workgroup_size(64) fn main() { x = (x + x - -x * x) / (x * x.y); }";
    let spirv = exact_spirv("main", &parse_text("main", source), &[]).unwrap();
    assert_eq!(float_results(&spirv).len(), 6);
}

#[test]
fn decorations_stand_where_drivers_read_them() {
    for shader in SHADERS {
        let spirv = &exact_variants(shader)[0];
        let opcodes: Vec<u32> = instructions(spirv).map(|(opcode, _)| opcode).collect();
        let last_decoration = opcodes.iter().rposition(|&o| o == OP_DECORATE).unwrap();
        // OpTypeVoid to OpTypeForwardPointer: types come after all annotations, names before (section 2.4).
        let first_type = opcodes.iter().position(|o| (19..=39).contains(o)).unwrap();
        let last_name = opcodes.iter().rposition(|o| (5..=6).contains(o)).unwrap_or(0);
        let first_decoration = opcodes.iter().position(|&o| o == OP_DECORATE).unwrap();
        assert!(last_decoration < first_type, "{}", shader.name);
        assert!(last_name < first_decoration, "{}", shader.name);
    }
}

#[test]
fn missing_decorations_are_noticed() {
    let shader = SHADERS.iter().find(|s| s.name == "candidates").unwrap();
    let spirv = &exact_variants(shader)[0];
    let plain: Vec<u32> = instructions(spirv)
        .filter(|(o, w)| !is_no_contraction(*o, w))
        .flat_map(|(_, words)| words.iter().copied())
        .collect();
    let plain = [&spirv[..HEADER], &plain].concat();
    assert!(!float_results(spirv).is_empty());
    assert_eq!(contractible(&plain), Vec::from_iter(float_results(spirv)));
}

/// Why drivers may disagree about an expression, if they may.
fn doubt(module: &Module, info: &FunctionInfo, expression: &Expression) -> Option<String> {
    let is_float = |handle: Handle<Expression>| {
        let inner = info[handle].ty.inner_with(&module.types);
        inner.scalar_kind() == Some(ScalarKind::Float)
    };
    match *expression {
        Expression::Math { fun, arg, .. } if is_float(arg) => {
            // Exact everywhere for finite numbers: bits, comparisons, and the root that IEEE 754 rounds.
            use MathFunction::{Abs, Floor, Max, Min, Sqrt};
            (!matches!(fun, Abs | Floor | Max | Min | Sqrt)).then(|| format!("{fun:?}"))
        }
        // Rust and WGSL define it alike, drivers compute it in other ways.
        Expression::Binary { op: BinaryOperator::Modulo, left, .. } if is_float(left) => {
            Some("remainder".into())
        }
        // SwiftShader rounds large unsigned integers in another direction.
        Expression::As { expr, kind: ScalarKind::Float, convert: Some(_) } if !is_float(expr) => {
            Some("integer to float".into())
        }
        _ => None,
    }
}

/// All doubts about a module. Functions that no entry point calls count too: they may be called tomorrow.
fn doubts(name: &str, module: &Module) -> Vec<String> {
    let info = validate(name, module);
    let in_function = |function: &Function, info: &FunctionInfo| -> Vec<String> {
        function.expressions.iter().filter_map(|(_, e)| doubt(module, info, e)).collect()
    };
    let functions = module.functions.iter().map(|(handle, f)| in_function(f, &info[handle]));
    let entries = module.entry_points.iter().enumerate();
    let entries = entries.map(|(i, entry)| in_function(&entry.function, info.get_entry_point(i)));
    let mut doubts: Vec<String> = functions.chain(entries).flatten().collect();
    // The order in which a product with a matrix adds up is open.
    let is_matrix = |inner: &TypeInner| matches!(inner, TypeInner::Matrix { .. });
    doubts
        .extend(module.types.iter().filter(|(_, t)| is_matrix(&t.inner)).map(|_| "matrix".into()));
    doubts
}

#[test]
fn kernels_use_only_what_drivers_agree_on() {
    for shader in SHADERS {
        assert_eq!(doubts(shader.name, &parse(shader)), [""; 0], "{}", shader.name);
    }
}

#[test]
fn what_drivers_disagree_on_is_noticed() {
    let cases = [
        ("acos(x)", "Acos"),
        ("atan2(x, y)", "Atan2"),
        ("normalize(v).x", "Normalize"),
        ("mix(x, y, x)", "Mix"),
        ("fma(x, y, x)", "Fma"),
        ("distance(v, -v)", "Distance"),
        ("length(v)", "Length"),
        ("dot(v, v)", "Dot"),
        ("cross(v, v).x", "Cross"),
        ("inverseSqrt(x)", "InverseSqrt"),
        ("x % y", "remainder"),
        ("f32(bitcast<u32>(x))", "integer to float"),
        ("(mat3x3(v, v, v) * v).x", "matrix"),
    ];
    for (text, found) in cases {
        let source = format!("fn f(x: f32, y: f32, v: vec3<f32>) -> f32 {{ return {text}; }}");
        assert_eq!(doubts(text, &parse_text(text, &source)), [found], "{text}");
    }
    let good = "fn f(x: f32, n: u32) -> f32 { return sqrt(abs(x)) + select(x, 1.0, \
        firstTrailingBit(n) % 2u == min(n, 3u)) * floor(max(x, 0.5)); }";
    assert_eq!(doubts("good", &parse_text("good", good)), [""; 0]);
}

/// A member of a record: name, offset and type.
type Member = (String, usize, String);

/// The members of a Rust record. A field that is left out does not compile.
macro_rules! members {
    ($type:ident { $($field:ident),* }) => {{
        let record = $type::default();
        let field = |name: &str, offset, ty: &str| (name.to_owned(), offset, ty.to_owned());
        let $type { $($field: _,)* } = record;
        vec![$(field(
            stringify!($field), offset_of!($type, $field), type_name_of_val(&record.$field)
        )),*]
    }};
}

/// The members and the size of a WGSL struct.
fn wgsl_record(module: &Module, name: &str) -> (Vec<Member>, usize) {
    let mut types = module.types.iter().map(|(_, ty)| ty);
    let ty = types.find(|ty| ty.name.as_deref() == Some(name)).expect(name);
    let TypeInner::Struct { members, span } = &ty.inner else { panic!("{name} is no struct") };
    let member = |m: &naga::StructMember| {
        let ty = rust_name(&module.types[m.ty].inner);
        (m.name.clone().unwrap(), m.offset as usize, ty)
    };
    (members.iter().map(member).collect(), *span as usize)
}

/// What a type of the records is called in Rust.
fn rust_name(inner: &TypeInner) -> String {
    let scalar = |s: &naga::Scalar| match (s.kind, s.width) {
        (ScalarKind::Float, 4) => "f32",
        (ScalarKind::Uint, 4) => "u32",
        _ => panic!("{s:?} has no counterpart"),
    };
    match inner {
        TypeInner::Scalar(s) | TypeInner::Atomic(s) => scalar(s).into(),
        TypeInner::Vector { size, scalar: s } => format!("[{}; {}]", scalar(s), *size as u8),
        other => panic!("{other:?} has no counterpart"),
    }
}

fn shared_records() -> Module {
    parse_text("records", &files("shaders/shared")["records"])
}

#[test]
fn records_are_laid_out_alike() {
    use records::{Candidate, Dispatch, Fan, Point};
    let module = shared_records();
    let point = members!(Point { position, radius, normal, level });
    assert_eq!(wgsl_record(&module, "Point"), (point, size_of::<Point>()));
    let fan = members!(Fan { slots, near, left_over, around, conflicts });
    assert_eq!(wgsl_record(&module, "Fan"), (fan, size_of::<Fan>()));
    let dispatch = members!(Dispatch { x, y, z, w, first });
    assert_eq!(wgsl_record(&module, "Dispatch"), (dispatch, size_of::<Dispatch>()));
    let candidate = members!(Candidate { place, normal, state, corners, size });
    assert_eq!(wgsl_record(&module, "Candidate"), (candidate.clone(), size_of::<Candidate>()));
    // These have the state as an atomic.
    for name in ["insertion", "selection"] {
        let shader = SHADERS.iter().find(|s| s.name == name).unwrap();
        assert_eq!(wgsl_record(&parse(shader), "SharedCandidate").0, candidate, "{name}");
    }
}

#[test]
fn parameters_are_laid_out_alike() {
    use records::Params;
    let module = shared_records();
    let mut params = members!(Params {
        origin,
        inverse_cell,
        bits,
        cell,
        sin_theta_f,
        theta_c,
        lambda1,
        lambda2,
        points,
        slots,
        triangles,
        candidates,
        level,
        records,
        arena_words,
        ring_entries,
        around_entries,
        mirror_links,
        longest_half,
        softest_crease,
        segment_origin,
        segment_inverse_cell,
        segment_bits,
        segment_cell,
        segments_begin,
        segment_cells_begin,
        segment_entries_begin,
        unused
    });
    params.pop();
    let (members, size) = wgsl_record(&module, "Params");
    assert_eq!(members, params);
    // A uniform's size is a multiple of 16.
    assert_eq!(size.next_multiple_of(16), size_of::<Params>());
}

#[test]
fn counters_are_laid_out_alike() {
    use records::Counters;
    let module = shared_records();
    let counters = members!(Counters {
        arena,
        arena_peak,
        slots,
        around,
        around_high,
        mirrored,
        mirrored_high,
        classes,
        isolated,
        ball_low,
        ball_high,
        left_over,
        longest_row,
        cut_loops,
        widest
    });
    assert_eq!(wgsl_record(&module, "Counters"), (counters, size_of::<Counters>()));
}

/// Bits of a constant of a shared file.
fn constant(file: &str, name: &str) -> u32 {
    let text = files("shaders/shared").remove(file).or_else(|| files("shaders").remove(file));
    let text = text.unwrap_or_else(|| panic!("there is no {file}.wgsl"));
    // What the file expects of others is left out with everything but the constant.
    let declares = |line: &&str| line.starts_with(&format!("const {name}:"));
    let line = text.lines().find(declares);
    let line = line.unwrap_or_else(|| panic!("{file}.wgsl has no constant {name}"));
    let module = parse_text(file, line);
    let (_, found) = module.constants.iter().next().expect("it is declared");
    match module.global_expressions[found.init] {
        Expression::Literal(Literal::F32(value)) => value.to_bits(),
        Expression::Literal(Literal::U32(value)) => value,
        ref other => panic!("{name} is {other:?}"),
    }
}

#[test]
fn constants_are_those_of_the_reference() {
    use surfine::testing::curves::{RECORD_WORDS, SEGMENT_WORDS};
    use surfine_reference::{
        candidates, coloring, conflicts, insertion, neighborhood, pn_triangle, visible,
    };
    let cases = [
        ("cover", "COVER", insertion::COVER.to_bits()),
        ("new_ring", "HYSTERESIS", insertion::HYSTERESIS.to_bits()),
        ("new_ring", "SMALLEST_SPLIT", insertion::SMALLEST_SPLIT.to_bits()),
        ("new_ring", "LESS", insertion::LESS.to_bits()),
        ("fan_triangle", "WIDEST_GAP", candidates::WIDEST_GAP.to_bits()),
        ("fan_triangle", "WIDEST_SHEET", candidates::WIDEST_SHEET.to_bits()),
        ("visible", "SAME_PLACE", visible::SAME_PLACE.to_bits()),
        ("visible", "LIKE", visible::LIKE.to_bits()),
        ("visible", "STEEP_SIDE", visible::STEEP.to_bits()),
        ("visible", "BEHIND", visible::BEHIND.to_bits()),
        ("visible", "CREASE_BEHIND", visible::CREASE_BEHIND.to_bits()),
        ("fences", "FENCE_REACH", visible::FENCE_REACH.to_bits()),
        ("curves", "RECORD_WORDS", RECORD_WORDS as u32),
        ("curves", "SEGMENT_WORDS", SEGMENT_WORDS as u32),
        ("records", "LEVEL_BITS", records::LEVEL_BITS),
        ("rows_arena", "ARENA_BLOCK", records::ARENA_BLOCK),
        ("ball", "OPPOSITE", neighborhood::OPPOSITE.to_bits()),
        ("ball", "NARROW", neighborhood::NARROW.to_bits()),
        ("ball", "DOUBTFUL_SHARE", neighborhood::DOUBTFUL.to_bits()),
        ("candidates_home", "NATURAL", candidates::NATURAL.to_bits()),
        ("candidates", "THIRD", candidates::THIRD.to_bits()),
        ("fuzzy_planes", "WORST_BADNESS", neighborhood::WORST_BADNESS.to_bits()),
        ("new_normal", "FAR", pn_triangle::FAR.to_bits()),
        ("new_normal", "BLEND", pn_triangle::BLEND.to_bits()),
        ("natural", "OPEN_GAP", neighborhood::OPEN_GAP.to_bits()),
        ("pn_triangle", "FLAT", pn_triangle::FLAT.to_bits()),
        ("new_normal", "STEEP", pn_triangle::STEEP.to_bits()),
        ("new_normal", "STEP", pn_triangle::STEP.to_bits()),
        ("new_normal", "STEP_BLEND", pn_triangle::STEP_BLEND.to_bits()),
        ("math", "TAU", surfine_reference::math::TAU.to_bits()),
        ("math", "PI", surfine_reference::math::PI.to_bits()),
        ("math", "HALF_PI", std::f32::consts::FRAC_PI_2.to_bits()),
        ("records", "NONE", surfine_reference::NO_POINT),
        ("records", "FREE", insertion::FREE),
        ("boundary_gaps", "STRAIGHT", surfine_features::STRAIGHT.to_bits()),
        ("conflicts", "WIDER", conflicts::SLACK.to_bits()),
        ("priority", "RANGES", coloring::RANGES as u32),
    ];
    for (file, name, expected) in cases {
        assert_eq!(constant(file, name), expected, "{name} in {file}.wgsl");
    }
}

#[test]
fn points_are_left_over_where_their_rows_do_not_fit() {
    for (file, name, kernel) in [
        ("selection_radii", "LONGEST_NEXT", "next_ring"),
        ("conflicts", "LONGEST_NEXT", "next_ring"),
        ("conflicts", "LONGEST_NEW", "insertion"),
    ] {
        assert_eq!(constant(file, name), constant(kernel, "CAPACITY"), "{name} in {file}.wgsl");
    }
}

/// The stages of both selections by their words, as the reference reports them.
fn stages() -> BTreeSet<&'static str> {
    let points = surfine_points::shapes::hexagonal_grid(1);
    let stages = |largest_first: bool| {
        let rules = Rules { largest_first, ..Rules::ALL };
        let params = RefineParams { rules, ..RefineParams::default() };
        let refined = surfine_reference::refine(&points, &params).unwrap();
        refined.reports[0].stages.iter().map(|(stage, _)| *stage).collect::<Vec<_>>()
    };
    [true, false].into_iter().flat_map(stages).collect()
}

/// What the comment at the head of a kernel file says of its twins: the functions that it names, and the files.
fn twins(text: &str) -> Option<(Vec<&str>, Vec<&str>)> {
    let head = text.split("\n\n").next()?;
    let said = head.split_once("Twin")?.1;
    // Up to the next sentence: a capital, but for "eq. 6".
    let next =
        said.match_indices(". ").find(|(at, _)| said[at + 2..].starts_with(char::is_uppercase));
    let said = &said[..next.map_or(said.len(), |(at, _)| at)];
    let said = ["\n//\n", "\n// One "].iter().fold(said, |s, end| s.split(end).next().unwrap());
    let names = said.split('`').skip(1).step_by(2).collect();
    let words = said.split([' ', '\n', ',', ';']).map(|word| word.trim_end_matches('.'));
    let files = words.filter(|word| word.ends_with(".rs") || word.ends_with(".wgsl")).collect();
    Some((names, files))
}

/// Whether Rust or WGSL defines something of that name.
fn defines(code: &str, name: &str) -> bool {
    let last = name.rsplit("::").next().unwrap();
    ["fn", "struct", "const"].iter().any(|kind| {
        let definition = format!("{kind} {last}");
        let mut after = code.split(definition.as_str()).skip(1);
        after.any(|rest| !rest.starts_with(|c: char| c.is_alphanumeric() || c == '_'))
    })
}

#[test]
fn twins_are_where_kernels_say() {
    let mut found = 0;
    for folder in ["shaders", "shaders/shared"] {
        for (stem, text) in files(folder) {
            let Some((names, paths)) = twins(&text) else { continue };
            assert!(!paths.is_empty(), "{stem}.wgsl names no file");
            let read = |path: &&str| {
                let base = if path.ends_with(".wgsl") { root().join(folder) } else { root() };
                fs::read_to_string(base.join(path))
                    .unwrap_or_else(|e| panic!("{stem}: {path}: {e}"))
            };
            let code: String = paths.iter().map(read).collect();
            for name in &names {
                assert!(defines(&code, name), "{stem}.wgsl: no `{name}` in {paths:?}");
            }
            found += 1;
        }
    }
    assert!(found > 40, "{found} files name a twin");
}

#[test]
fn stages_have_one_word_everywhere() {
    let path = root().join("docs/algorithm.md");
    let text = fs::read_to_string(&path).unwrap_or_else(|e| panic!("{}: {e}", path.display()));
    let headings: Vec<&str> = text.lines().filter_map(|line| line.strip_prefix("## ")).collect();
    let stages = stages();
    assert_eq!(stages.len(), 10);
    for stage in &stages {
        let found = headings.iter().any(|h| h.split_whitespace().next() == Some(stage));
        assert!(found, "docs/algorithm.md has no heading `## {stage}`");
    }
}

#[test]
fn kernels_are_named_after_their_stages() {
    let stages = stages();
    for shader in SHADERS {
        let is_helper = ["scan_", "sort_"].iter().any(|prefix| shader.name.starts_with(prefix));
        let head = shader.files[0].strip_prefix("// ").and_then(|text| text.split_once(": "));
        let stage = head.map(|(word, _)| word).filter(|word| stages.contains(word));
        match stage {
            None => assert!(is_helper, "{}: the first line names no stage", shader.name),
            // The colouring's classes are named by what they are.
            Some("coloring") if shader.name == "class_count" => {}
            Some(word) => assert!(shader.name.starts_with(word), "{}: of {word}", shader.name),
        }
    }
}
