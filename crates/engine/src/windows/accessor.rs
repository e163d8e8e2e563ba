//! The functions that choose the window of an array.

use super::{Access, Place, Windowed};
use naga::{
    BinaryOperator, Block, Expression, Function, FunctionArgument, FunctionResult, GlobalVariable,
    Handle, Literal, Range, Scalar, Span, Statement, SwitchCase, SwitchValue, Type, TypeInner,
    UniqueArena,
};

/// The function for an access: it takes the index, and the value if there is one, and gives what is loaded.
pub(super) fn accessor(
    types: &mut UniqueArena<Type>,
    array: &Windowed,
    place: &Place,
    access: Access,
) -> Function {
    let uint = scalar_type(types, Scalar::U32);
    let ty = value_type(types, array.element, &place.members);
    let argument = |ty| FunctionArgument { name: None, ty, binding: None };
    let takes_value = !matches!(access, Access::Load);
    let gives_value = !matches!(access, Access::Store);
    let mut function = Function {
        name: Some("window".into()),
        arguments: [vec![argument(uint)], vec![argument(ty); takes_value.into()]].concat(),
        result: gives_value.then_some(FunctionResult { ty, binding: None }),
        ..Default::default()
    };
    let left = add(&mut function, Expression::FunctionArgument(0));
    let value = takes_value.then(|| add(&mut function, Expression::FunctionArgument(1)));
    let right = add(&mut function, Expression::Literal(Literal::U32(array.items)));
    let op = BinaryOperator::Divide;
    let selector = add(&mut function, Expression::Binary { op, left, right });
    let op = BinaryOperator::Modulo;
    let index = add(&mut function, Expression::Binary { op, left, right });
    let mut cases = Vec::new();
    for (i, &variable) in array.variables.iter().enumerate() {
        let (body, pointer) = point(&mut function, (variable, index), &place.members);
        let body = act(&mut function, body, (pointer, value), access, ty);
        cases.push(SwitchCase { value: SwitchValue::U32(i as u32), body, fall_through: false });
    }
    if let Some(last) = cases.last_mut() {
        last.value = SwitchValue::Default;
    }
    function.body.push(Statement::Emit(Range::new_from_bounds(selector, index)), Span::UNDEFINED);
    function.body.push(Statement::Switch { selector, cases }, Span::UNDEFINED);
    function
}

fn add(function: &mut Function, expression: Expression) -> Handle<Expression> {
    function.expressions.append(expression, Span::UNDEFINED)
}

/// A pointer to a member of an element.
fn point(
    function: &mut Function,
    (variable, index): (Handle<GlobalVariable>, Handle<Expression>),
    members: &[u32],
) -> (Block, Handle<Expression>) {
    let base = add(function, Expression::GlobalVariable(variable));
    let element = add(function, Expression::Access { base, index });
    let member = |base, &index| add(function, Expression::AccessIndex { base, index });
    let pointer = members.iter().fold(element, member);
    (Block::from_vec(vec![Statement::Emit(Range::new_from_bounds(element, pointer))]), pointer)
}

/// What is done there.
fn act(
    function: &mut Function,
    mut body: Block,
    (pointer, value): (Handle<Expression>, Option<Handle<Expression>>),
    access: Access,
    ty: Handle<Type>,
) -> Block {
    let result = match (access, value) {
        (Access::Store, Some(value)) => {
            body.push(Statement::Store { pointer, value }, Span::UNDEFINED);
            None
        }
        (Access::Atomic(fun), Some(value)) => {
            let result = Some(add(function, Expression::AtomicResult { ty, comparison: false }));
            body.push(Statement::Atomic { pointer, fun, value, result }, Span::UNDEFINED);
            result
        }
        _ => {
            let result = add(function, Expression::Load { pointer });
            let emit = Statement::Emit(Range::new_from_bounds(result, result));
            body.push(emit, Span::UNDEFINED);
            Some(result)
        }
    };
    body.push(Statement::Return { value: result }, Span::UNDEFINED);
    body
}

/// The type of the values at a place.
fn value_type(
    types: &mut UniqueArena<Type>,
    element: Handle<Type>,
    members: &[u32],
) -> Handle<Type> {
    let mut at = element;
    for &member in members {
        at = match &types[at].inner {
            TypeInner::Struct { members, .. } => members[member as usize].ty,
            &TypeInner::Vector { scalar, .. } => scalar_type(types, scalar),
            other => unreachable!("{other:?} has no members of its own"),
        };
    }
    match types[at].inner {
        TypeInner::Atomic(scalar) => scalar_type(types, scalar),
        _ => at,
    }
}

fn scalar_type(types: &mut UniqueArena<Type>, scalar: Scalar) -> Handle<Type> {
    types.insert(Type { name: None, inner: TypeInner::Scalar(scalar) }, Span::UNDEFINED)
}
