"""Uses of frameworks of ROS 2 that no call shows: base classes, and headers that are generated."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

from kg.extract.cpp import syntax
from kg.extract.marks import Mark
from kg.facts import Location

if TYPE_CHECKING:
    from collections.abc import Iterator

    from kg.extract.cpp.program import Program
    from kg.extract.cpp.unit import Class, Unit

__all__ = ["framework_marks"]

_LIFECYCLE: Final = frozenset({"LifecycleNode", "CascadeLifecycleNode"})
_GENERATED: Final = "_parameters.hpp"


def framework_marks(program: Program, cls: Class | None) -> Iterator[Mark]:
    """Yield the marks of a node made of the class `cls`, or of whatever a program reaches where that is None."""
    for one in [cls] if cls is not None else list(program.live):
        for member in program.family(one):
            if any(syntax.simple_name(base) in _LIFECYCLE for base in member.bases):
                yield Mark("ros2.lifecycle", _place(program, one.unit, one.unit.line(one.start)))
    for unit in tuple(program.units.values()):
        for path in unit.includes:
            if path.endswith(_GENERATED) and program.project.include(unit.file, path) is None:
                line = unit.line(max(unit.source.find(path.encode()), 0))
                target = path.rpartition("/")[2].removesuffix(".hpp")
                yield Mark("generate_parameter_library", _place(program, unit, line), detail=target)


def _place(program: Program, unit: Unit, line: int) -> Location:
    other = None if unit.file.repository == program.project.repository else unit.file.repository
    return Location(unit.file.path, line, other)
