"""The type that a callback takes: from functions, methods, lambdas, `bind` and function objects."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

from kg.extract.cpp import syntax
from kg.extract.cpp.context import Site
from kg.extract.cpp.unit import Expr, read_parameters
from kg.extract.cpp.variables import WriteKind, writes

if TYPE_CHECKING:
    from collections.abc import Iterator

    from tree_sitter import Node

    from kg.extract.cpp.context import Context
    from kg.extract.cpp.evaluate import Evaluator
    from kg.extract.cpp.unit import Class, Unit

__all__ = ["callback_types"]

_PLACEHOLDERS: Final = ("_1", "std::placeholders::_1", "boost::placeholders::_1", "placeholders::_1", "std::ph::_1")
_FUNCTIONS: Final = frozenset({"function", "Callback"})
_DEEPEST: Final = 6


def callback_types(
    evaluator: Evaluator, where: Expr, context: Context, depth: int = 0
) -> Iterator[tuple[str, Context]]:
    """Yield the interface types (`package/Type`) that the first message parameter of a callback can have."""
    node = syntax.unwrap(where.node)
    where = where.child(node)
    if depth > _DEEPEST:
        return
    if node.type == "lambda_expression":
        declarator = node.child_by_field_name("declarator")
        if declarator is not None:
            yield from _parameter_type(evaluator, where.unit, declarator, 0, context)
    elif node.type == "call_expression":
        yield from _of_call(evaluator, where, context, depth)
    elif node.type in ("identifier", "qualified_identifier", "field_expression", "template_function"):
        yield from _of_function(evaluator, where, context, 0)
        if node.type != "qualified_identifier":
            yield from _of_variable(evaluator, where, context, depth)


def _of_call(evaluator: Evaluator, where: Expr, context: Context, depth: int) -> Iterator[tuple[str, Context]]:
    function = where.node.child_by_field_name("function")
    called = syntax.callee(function) if function is not None else None
    given = syntax.arguments(where.node.child_by_field_name("arguments"))
    if called is None or not given:
        return
    if called.name in ("bind", "bind_front"):
        bound = [syntax.text(argument).replace(" ", "") for argument in given[1:]]
        place = next((i for i, shown in enumerate(bound) if shown.endswith("_1") and shown in _PLACEHOLDERS), None)
        target = where.child(syntax.unwrap(given[0]))
        method = given[0].type == "pointer_expression" and "::" in syntax.text(given[0])
        index = 0 if place is None else place - method
        yield from _of_function(evaluator, target, context, index)
        return
    yield from callback_types(evaluator, where.child(given[0]), context, depth + 1)


def _of_function(evaluator: Evaluator, where: Expr, context: Context, index: int) -> Iterator[tuple[str, Context]]:
    """Yield the types from every function or method declared under the name."""
    called = syntax.callee(where.node)
    if called is None:
        return
    explicit = tuple(where.child(argument) for argument in syntax.arguments(called.template))
    cls = evaluator.program.find_class(called.scope[-1], where.unit, called.scope[:-1]) if called.scope else None
    if called.scope and cls is None:
        alias = evaluator.types.alias(called.scope[-1], where.unit, where.at)
        settled = evaluator.types.settle(alias, context) if alias is not None else []
        cls = evaluator.types.class_of(settled[0][0]) if settled else None
    if cls is None:
        cls = evaluator.types.class_around(where.unit, where.at) if not called.scope else None
    for unit, declarator, key in _declarators(evaluator, called.name, cls, where.unit):
        inner = context.bind(key, Site(where, (), explicit)) if explicit and key is not None else context
        yield from _parameter_type(evaluator, unit, declarator, index, inner)


def _declarators(
    evaluator: Evaluator, name: str, cls: Class | None, near: Unit
) -> Iterator[tuple[Unit, Node, object | None]]:
    program = evaluator.program
    for base in program.family(cls) if cls is not None else ():
        for function in program.methods(base):
            if function.name == name and function.declarator is not None:
                yield function.unit, function.declarator, function
        known = base.fields.get(name)
        if known is not None and known[2].type == "function_declarator":
            yield base.unit, known[2], None
    if cls is None or name not in cls.fields:
        for function in sorted(program.functions(name), key=lambda f: f.unit is not near):
            if function.declarator is not None and program.owner(function) is None:
                yield function.unit, function.declarator, function
        for node in near.occurrences(name):
            parent = node.parent
            if (
                parent is not None
                and parent.type == "function_declarator"
                and near.function_at(node.start_byte) is None
            ):
                yield near, parent, None


def _parameter_type(
    evaluator: Evaluator, unit: Unit, declarator: Node, index: int, context: Context
) -> Iterator[tuple[str, Context]]:
    parameters = read_parameters(declarator)
    if index >= len(parameters):
        return
    kind = parameters[index].type
    if kind is None:
        return
    for message, chosen in evaluator.types.message(Expr.of(unit, kind), context):
        if message is not None:
            yield message, chosen


def _of_variable(evaluator: Evaluator, where: Expr, context: Context, depth: int) -> Iterator[tuple[str, Context]]:
    """Yield the types from what a variable, member or parameter holding a callback is declared as or set to."""
    name = syntax.simple_name(where.node) if where.node.type != "field_expression" else ""
    if where.node.type == "field_expression":
        field = where.node.child_by_field_name("field")
        name = syntax.text(field) if field is not None else ""
    declared = evaluator.types.declaration(name, where)
    if declared is not None:
        found = False
        for kind, chosen in _of_signature(evaluator, declared[0], context):
            found = True
            yield kind, chosen
        if found:
            return
    function = where.unit.function_at(where.at)
    if function is None:
        return
    for write in writes(where.unit, name, function.start, function.end):
        if write.kind is WriteKind.VALUE:
            yield from callback_types(evaluator, write.value, context, depth + 1)
        elif write.kind is WriteKind.PARAMETER:
            index = next((i for i, p in enumerate(function.parameters) if p.name == name), None)
            for site, chosen in evaluator.flow.entries(function, context) if index is not None else ():
                if index is not None and index < len(site.arguments):
                    yield from callback_types(evaluator, site.arguments[index], chosen, depth + 1)


def _of_signature(evaluator: Evaluator, where: Expr, context: Context) -> Iterator[tuple[str, Context]]:
    """Yield the type in `function<void(const Message&)>`, through aliases."""
    for settled, chosen in evaluator.types.settle(where, context):
        if settled.name not in _FUNCTIONS or not settled.arguments:
            continue
        signature = settled.arguments[0].node
        declarator = signature.child_by_field_name("declarator")
        if declarator is not None and declarator.child_by_field_name("parameters") is not None:
            yield from _parameter_type(evaluator, settled.arguments[0].unit, declarator, 0, chosen)
