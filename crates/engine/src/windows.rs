//! Buffers that are longer than a binding may be.
//!
//! Drivers bind 128 MiB or 2 GiB at most; buffers can be larger. A kernel sees such a buffer through several bindings,
//! its windows, which all have the same number of bytes but for the last one. The WGSL says nothing of them: where an
//! array has several, each access to one of its elements becomes a call of a function that chooses the window by the
//! index.

mod accessor;

use accessor::accessor;
use naga::{
    Arena, ArraySize, AtomicFunction, Block, Expression, Function, GlobalVariable, Handle, Module,
    Range, Span, Statement, Type, TypeInner,
};
use std::collections::HashMap;

/// A multiple of the bytes of every record.
pub(crate) const RECORDS: u64 = 96;
/// Windows begin at multiples of so many bytes: no record is cut, and drivers ask for 256 at most.
const GRAIN: u64 = 8 * RECORDS;

/// Bytes of a window where a binding may have so many.
pub(crate) fn window_bytes(largest_binding: u64) -> u64 {
    (largest_binding / GRAIN * GRAIN).max(GRAIN)
}

/// An array with several windows.
struct Windowed {
    variables: Vec<Handle<GlobalVariable>>,
    element: Handle<Type>,
    /// Elements of a window.
    items: u32,
}

/// A place in such an array: the element and the members that lead on from it.
#[derive(Clone)]
struct Place {
    array: usize,
    index: Handle<Expression>,
    members: Vec<u32>,
}

/// What is done at a place.
#[derive(Clone, Copy)]
enum Access {
    Load,
    Store,
    Atomic(AtomicFunction),
}

/// Gives arrays more bindings: as many windows as `counts` says of each binding from 2 on. Those after the first follow
/// the last binding of the module, in the order of the arrays.
///
/// # Errors
/// What should have several windows is no array of any length, or is used otherwise than element by element.
pub(crate) fn split(module: &mut Module, counts: &[u32], bytes: u64) -> Result<(), String> {
    let arrays = declare(module, counts, bytes)?;
    // Functions stand before those that call them. So all are gone through twice: to make the accessors, and to call
    // them.
    let mut functions = Arena::new();
    let old: Vec<_> = module.functions.drain().map(|(_, function, _)| function).collect();
    for function in old.iter().chain(module.entry_points.iter().map(|entry| &entry.function)) {
        let accessor = &mut |place: &Place, access| {
            let accessor = accessor(&mut module.types, &arrays[place.array], place, access);
            functions.append(accessor, Span::UNDEFINED)
        };
        Redirected::new(&mut function.clone(), &arrays, &[])?.body(accessor)?;
    }
    let accessors: Vec<_> = functions.iter().map(|(handle, _)| handle).collect();
    let mut accessors = accessors.into_iter();
    let next = &mut |_: &Place, _| accessors.next().expect("both rounds meet the same accesses");
    let mut moved = Vec::new();
    for mut function in old {
        Redirected::new(&mut function, &arrays, &moved)?.body(next)?;
        moved.push(functions.append(function, Span::UNDEFINED));
    }
    for entry in &mut module.entry_points {
        Redirected::new(&mut entry.function, &arrays, &moved)?.body(next)?;
    }
    module.functions = functions;
    Ok(())
}

/// Declares the further windows.
fn declare(module: &mut Module, counts: &[u32], bytes: u64) -> Result<Vec<Windowed>, String> {
    let variables = &mut module.global_variables;
    let mut bound: Vec<_> =
        variables.iter().filter_map(|(handle, v)| Some((v.binding?.binding, handle))).collect();
    bound.sort_unstable_by_key(|(binding, _)| *binding);
    let mut last = bound.last().map_or(0, |(binding, _)| *binding);
    let mut arrays = Vec::new();
    for (binding, first) in bound {
        let count = binding.checked_sub(2).map_or(1, |i| counts[i as usize]);
        if count == 1 {
            continue;
        }
        let variable = variables[first].clone();
        let TypeInner::Array { base, stride, size: ArraySize::Dynamic } =
            module.types[variable.ty].inner
        else {
            return Err(format!("binding {binding} is no array and has one window only"));
        };
        let mut handles = vec![first];
        for _ in 1..count {
            last += 1;
            let binding = variable.binding.map(|b| naga::ResourceBinding { binding: last, ..b });
            let window = GlobalVariable { binding, ..variable.clone() };
            handles.push(variables.append(window, Span::UNDEFINED));
        }
        let items = u32::try_from(bytes / u64::from(stride)).unwrap_or(u32::MAX);
        arrays.push(Windowed { variables: handles, element: base, items });
    }
    Ok(arrays)
}

/// A function whose accesses to arrays with several windows become calls.
struct Redirected<'a> {
    function: &'a mut Function,
    places: HashMap<Handle<Expression>, Place>,
    /// Where the functions that it calls are now, if they have moved.
    moved: &'a [Handle<Function>],
}

/// Gives the function for an access: each has its own.
type Accessor<'a> = &'a mut dyn FnMut(&Place, Access) -> Handle<Function>;

impl<'a> Redirected<'a> {
    fn new(
        function: &'a mut Function,
        arrays: &[Windowed],
        moved: &'a [Handle<Function>],
    ) -> Result<Self, String> {
        let places = places(function, arrays)?;
        for (_, expression) in function.expressions.iter_mut() {
            if let Expression::CallResult(callee) = expression {
                *callee = moved.get(callee.index()).copied().unwrap_or(*callee);
            }
        }
        Ok(Self { function, places, moved })
    }

    fn body(mut self, accessor: Accessor<'_>) -> Result<(), String> {
        let body = std::mem::take(&mut self.function.body);
        self.function.body = self.block(body, accessor)?;
        Ok(())
    }

    fn block(&mut self, block: Block, accessor: Accessor<'_>) -> Result<Block, String> {
        let mut redirected = Block::new();
        for (mut statement, span) in block.span_into_iter() {
            match &mut statement {
                Statement::Emit(range) => {
                    self.emit(range.clone(), &mut redirected, accessor);
                    continue;
                }
                &mut Statement::Store { pointer, value } => {
                    if let Some(place) = self.places.get(&pointer) {
                        let function = accessor(place, Access::Store);
                        let arguments = vec![place.index, value];
                        statement = Statement::Call { function, arguments, result: None };
                    }
                }
                &mut Statement::Atomic { pointer, fun, value, result } => {
                    if let Some(place) = self.places.get(&pointer) {
                        if let AtomicFunction::Exchange { compare: Some(_) } = fun {
                            return Err("a windowed array is compared and exchanged".into());
                        }
                        let function = accessor(place, Access::Atomic(fun));
                        let arguments = vec![place.index, value];
                        if let Some(result) = result {
                            self.function.expressions[result] = Expression::CallResult(function);
                        }
                        statement = Statement::Call { function, arguments, result };
                    }
                }
                Statement::Call { function, .. } => {
                    *function = self.moved.get(function.index()).copied().unwrap_or(*function);
                }
                Statement::Block(inner) => self.inside(inner, accessor)?,
                Statement::If { accept, reject, .. } => {
                    self.inside(accept, accessor)?;
                    self.inside(reject, accessor)?;
                }
                Statement::Switch { cases, .. } => {
                    cases.iter_mut().try_for_each(|case| self.inside(&mut case.body, accessor))?;
                }
                Statement::Loop { body, continuing, .. } => {
                    self.inside(body, accessor)?;
                    self.inside(continuing, accessor)?;
                }
                _ => (),
            }
            redirected.push(statement, span);
        }
        Ok(redirected)
    }

    fn inside(&mut self, block: &mut Block, accessor: Accessor<'_>) -> Result<(), String> {
        *block = self.block(std::mem::take(block), accessor)?;
        Ok(())
    }

    /// Loads at places become calls between the expressions before and after them.
    fn emit(&mut self, range: Range<Expression>, block: &mut Block, accessor: Accessor<'_>) {
        let mut pending: Option<(Handle<Expression>, Handle<Expression>)> = None;
        let flush = |pending: &mut Option<_>, block: &mut Block| {
            if let Some((first, last)) = pending.take() {
                block.push(Statement::Emit(Range::new_from_bounds(first, last)), Span::UNDEFINED);
            }
        };
        for handle in range {
            let place = match self.function.expressions[handle] {
                Expression::Load { pointer } => self.places.get(&pointer),
                _ => None,
            };
            let Some(place) = place else {
                pending = Some((pending.map_or(handle, |(first, _)| first), handle));
                continue;
            };
            flush(&mut pending, block);
            let function = accessor(place, Access::Load);
            let (arguments, result) = (vec![place.index], Some(handle));
            block.push(Statement::Call { function, arguments, result }, Span::UNDEFINED);
            self.function.expressions[handle] = Expression::CallResult(function);
        }
        flush(&mut pending, block);
    }
}

/// The expressions of a function that point into arrays with several windows.
fn places(
    function: &Function,
    arrays: &[Windowed],
) -> Result<HashMap<Handle<Expression>, Place>, String> {
    let mut whole = HashMap::new();
    let mut places: HashMap<_, Place> = HashMap::new();
    for (handle, expression) in function.expressions.iter() {
        match *expression {
            Expression::GlobalVariable(variable) => {
                let array = arrays.iter().position(|a| a.variables[0] == variable);
                array.map(|array| whole.insert(handle, array));
            }
            Expression::Access { base, index } => {
                if let Some(&array) = whole.get(&base) {
                    places.insert(handle, Place { array, index, members: Vec::new() });
                } else if places.contains_key(&base) {
                    return Err("an element of a windowed array is indexed".into());
                }
            }
            Expression::AccessIndex { base, index } => {
                if let Some(&array) = whole.get(&base) {
                    if index >= arrays[array].items {
                        return Err("a constant index is beyond the first window".into());
                    }
                } else if let Some(mut place) = places.get(&base).cloned() {
                    place.members.push(index);
                    places.insert(handle, place);
                }
            }
            Expression::ArrayLength(base) if whole.contains_key(&base) => {
                return Err("the length of a windowed array is asked for".into());
            }
            _ => (),
        }
    }
    Ok(places)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::shaders::SHADERS;

    #[test]
    fn every_kernel_can_have_windows_for_all_its_arrays() {
        for shader in SHADERS {
            let mut module = naga::front::wgsl::parse_str(&shader.source()).unwrap();
            let of_any_length = |v: &GlobalVariable| {
                matches!(
                    module.types[v.ty].inner,
                    TypeInner::Array { size: ArraySize::Dynamic, .. }
                )
            };
            let mut counts = vec![1; module.global_variables.len()];
            for (_, variable) in module.global_variables.iter().filter(|(_, v)| of_any_length(v)) {
                let Some(binding) = variable.binding else { continue };
                counts[binding.binding as usize - 2] = 2 + binding.binding % 2;
            }
            let before = module.functions.len();
            split(&mut module, &counts, 7680).unwrap_or_else(|e| panic!("{}: {e}", shader.name));
            let has_windows = counts.iter().any(|count| *count > 1);
            assert_eq!(module.functions.len() > before, has_windows, "{}", shader.name);
            crate::kernel::exact_spirv(shader.entry, &module, &[])
                .unwrap_or_else(|e| panic!("{}: {e}", shader.name));
        }
    }
}
