"""Programs written for one test: C++ given as text, ready to evaluate."""

from __future__ import annotations

import tempfile
from pathlib import Path
from typing import TYPE_CHECKING

from extract.workspaces import reader_of

from kg.extract.cpp.api import Api
from kg.extract.cpp.context import EMPTY
from kg.extract.cpp.evaluate import Evaluator
from kg.extract.cpp.program import Program
from kg.extract.cpp.project import Project
from kg.extract.cpp.ros1 import Ros1
from kg.extract.cpp.ros2 import Ros2
from kg.extract.cpp.unit import Expr, Unit
from kg.extract.values import Text

if TYPE_CHECKING:
    from collections.abc import Mapping

    from kg.extract.values import Value

__all__ = ["evaluator_of", "message_of", "program_of", "texts_of", "unit_of", "values_of"]


def program_of(files: Mapping[str, str]) -> Program:
    """Return the program of these files, with all that its `main` reaches; a file `main.cpp` must be among them."""
    with tempfile.TemporaryDirectory() as root:
        reader = reader_of(Path(root), files)
        project = Project(reader, reader.package)
        program = Program(project, frozenset())
        program.load(file for file in project.sources() if file.path.endswith(".cpp"))
        for function in program.functions("main"):
            program.start(function)
        return program


def unit_of(source: str) -> Unit:
    """Return a file with this text."""
    return next(iter(program_of({"main.cpp": source}).units.values()))


def evaluator_of(source: str, more: Mapping[str, str] | None = None) -> Evaluator:
    """Return an evaluator for a program of one file, and further files by path."""
    return Evaluator(program_of({"main.cpp": source, **(more or {})}), Api((Ros1(), Ros2())))


def argument_of(evaluator: Evaluator, name: str) -> Expr:
    """Return the argument of the call of `name` with one argument."""
    for unit, node in evaluator.program.sites(name):
        call = node.parent
        given = call.child_by_field_name("arguments") if call is not None and call.type == "call_expression" else None
        if given is not None:
            return Expr.of(unit, given.named_children[0])
    raise LookupError(name)


def values_of(evaluator: Evaluator, name: str = "use") -> list[Value]:
    """Return the alternatives of the argument of the call of `name`."""
    return [value for value, _ in evaluator.values(argument_of(evaluator, name), EMPTY)]


def texts_of(source: str, more: Mapping[str, str] | None = None) -> list[str | None]:
    """Return the alternatives of the argument of `use(...)` in a program, None for what is no whole text."""
    found = values_of(evaluator_of(source, more))
    return [value.known if isinstance(value, Text) else None for value in found]


def message_of(written: str, before: str = "") -> str | None:
    """Return the interface type that a C++ type stands for, with code of the same file before it."""
    evaluator = evaluator_of(f"{before}\nint main() {{ {written} variable; use(variable); }}")
    kind = evaluator.types.of(argument_of(evaluator, "use"), EMPTY)
    return evaluator.types.as_message(kind) if kind is not None else None
