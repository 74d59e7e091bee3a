"""Which scopes a scope names: functions, classes and methods by the words in its text, through imports too.

Names decide here and nothing is evaluated, so the answer errs on the large side; it rests on files alone and is
remembered for all nodes of a package.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

from kg.extract.python.entities import ClassRef, Dotted, FunctionRef, ModuleRef
from kg.extract.python.program import mentions_ros

if TYPE_CHECKING:
    from collections.abc import Iterator

    from kg.extract.python.entities import Thing
    from kg.extract.python.program import Program
    from kg.extract.python.unit import Scope, Unit

__all__ = ["named_scopes"]

_PLAIN_BASES: Final = frozenset({"builtins.object", "builtins.Exception", "rclpy.node.Node", "enum.Enum"})
_MAX_PACKAGE_DEPTH: Final = 3


def named_scopes(program: Program, scope: Scope) -> tuple[Scope, ...]:
    """Return what a scope names or, as a class or module, brings with it; methods of unknown objects are left out.

    Code that looks names up in `globals()` names every class of its file.
    """
    known = program.named.get(id(scope))
    if known is None:
        known = program.named[id(scope)] = tuple(dict.fromkeys(_named(program, scope)))
    return known


def _named(program: Program, scope: Scope) -> Iterator[Scope]:
    words = scope.words
    if scope.kind == "class":
        yield from _of_class(program, scope)
    elif scope.kind == "module":
        yield from _of_module(program, scope.unit)
    around: Scope | None = scope
    while around is not None:
        yield from (inner for name, inner in around.functions.items() if name in words and around.kind != "class")
        yield from (inner for name, inner in around.classes.items() if name in words)
        around = around.parent
    if "globals" in words:
        yield from scope.unit.module.classes.values()
    yield from _through_imports(program, scope.unit, words)


def _of_class(program: Program, klass: Scope) -> Iterator[Scope]:
    """Yield what a class runs without being asked by name: its special methods and what a base outside calls."""
    lineage = program.lineage(klass)
    foreign = any(isinstance(base, Dotted) and base.path not in _PLAIN_BASES for base in lineage)
    for base in lineage:
        if isinstance(base, Dotted):
            continue
        if base is not klass:
            yield base
        for name, method in base.functions.items():
            if foreign or name.startswith("__"):
                yield method


def _of_module(program: Program, unit: Unit) -> Iterator[Scope]:
    """Yield the modules that a module imports, as far as they can declare anything."""
    for name in unit.imports:
        other = _unit_of(program.global_name(unit, name))
        if other is not None and mentions_ros(other.source):
            yield other.module
    for other in program.star_modules(unit):
        if mentions_ros(other.source):
            yield other.module


def _through_imports(program: Program, unit: Unit, words: frozenset[str]) -> Iterator[Scope]:
    """Yield functions and classes that are named through imports."""
    for name in sorted(words & unit.imports.keys()):
        value = program.global_name(unit, name)
        if isinstance(value, ClassRef | FunctionRef):
            yield value.scope
        elif isinstance(value, ModuleRef):
            yield from _members(program, value.unit, words)
    for other in program.star_modules(unit):
        yield from _members(program, other, words)


def _members(program: Program, unit: Unit, words: frozenset[str], depth: int = _MAX_PACKAGE_DEPTH) -> Iterator[Scope]:
    """Yield what is named of a module: its functions and classes, what it imports, modules below it."""
    scope = unit.module
    if unit.stars or unit.file.path.endswith("/__init__.py"):
        inside = words
    else:
        inside = words & (scope.functions.keys() | scope.classes.keys() | unit.imports.keys())
    for word in sorted(inside):
        value = program.global_name(unit, word) or program.submodule(unit, word)
        if isinstance(value, ClassRef | FunctionRef):
            yield value.scope
        elif isinstance(value, ModuleRef) and depth and value.unit is not unit:
            yield from _members(program, value.unit, words, depth - 1)


def _unit_of(value: Thing | None) -> Unit | None:
    if isinstance(value, ModuleRef):
        return value.unit
    return value.scope.unit if isinstance(value, ClassRef | FunctionRef) else None
