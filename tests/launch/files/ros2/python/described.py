"""Reading a launch file of a test, and its description as lines of text."""

from __future__ import annotations

from dataclasses import fields, is_dataclass
from typing import TYPE_CHECKING

from extract.workspaces import reader_of

from kg.facts import Location
from kg.launch.files.access import Files
from kg.launch.files.ros2.actions import Action, Condition, DeclareArgument, Group, Opaque, Substitution
from kg.launch.files.ros2.context import Context
from kg.launch.files.ros2.python.reading import read_python

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Mapping, Sequence
    from pathlib import Path

    from kg.facts import LaunchProblem

__all__ = ["described", "executed", "read_text"]


def read_text(
    root: Path, files: Mapping[str, str | bytes], given: Mapping[str, str] | None = None
) -> tuple[list[Action], list[LaunchProblem]]:
    """Return actions and problems of `launch.py` in the package `demo`, including bodies of opaque functions."""
    reader = reader_of(root, files)
    named = Files(reader)
    file = reader.file("demo/launch.py")
    problems: list[LaunchProblem] = []
    context = Context(named, file, given or {}, {})
    actions = list(executed(read_python(named, file, reader.read(file) or b"", problems)[0], context))
    return actions, [*problems, *context.results.problems]


def executed(actions: Iterable[Action], context: Context) -> Iterator[Action]:
    """Yield actions with opaque functions replaced by their results, with default arguments."""
    for action in actions:
        if isinstance(action, DeclareArgument) and action.default is not None:
            context.scope.configurations.setdefault(action.name, context.perform(action.default))
        if isinstance(action, Opaque):
            yield from executed(action.run(context), context)
        elif isinstance(action, Group):
            yield action
            executed(action.actions, context)
        else:
            yield action


def described(actions: Sequence[Action], problems: Sequence[LaunchProblem]) -> str:
    """Return a line for each action, with its content below it, and then one for each problem."""
    lines = [line for action in actions for line in _lines(action, 0)]
    lines += [f"{problem.location.line} {problem.kind}: {problem.message}" for problem in problems]
    return "\n".join(lines) + "\n"


def _lines(thing: object, depth: int) -> Iterator[str]:
    here: list[str] = []
    below: list[object] = []
    location: Location | None = getattr(thing, "location", None)
    for field in fields(thing):  # type: ignore[arg-type]  # only actions and what they hold come here
        value = getattr(thing, field.name)
        if field.name == "location" or value is None or value == field.default:
            continue
        if (
            isinstance(value, tuple)
            and value
            and all(is_dataclass(item) and not isinstance(item, Substitution) for item in value)
        ):
            below += value
        elif is_dataclass(value) and not isinstance(value, Condition):
            below.append(value)
        else:
            here.append(f"{field.name}={_shown(value)}")
    place = f"{location.path.removeprefix('demo/')}:{location.line}" if location else "-"
    yield f"{'    ' * depth}{place} {' '.join([type(thing).__name__, *here])}"
    for item in below:
        yield from _lines(item, depth + 1)


def _shown(value: object) -> str:
    if isinstance(value, Location):
        return f"@{value.line}"
    if isinstance(value, Condition):
        words = _shown(value.value) if value.value is not None else f"? {value.written}"
        return f"[{'not ' if value.negated else ''}{words}]"
    if isinstance(value, Substitution):
        return f"$({' '.join([value.kind, *map(_shown, value.arguments), *([value.reason] if value.reason else [])])})"
    if isinstance(value, tuple) and value and all(isinstance(part, str | Substitution) for part in value):
        return "".join(part if isinstance(part, str) else _shown(part) for part in value) or "''"
    if isinstance(value, tuple):
        return f"({', '.join(map(_shown, value))})" if value else "''"
    return repr(value) if isinstance(value, list | float | bool) else str(value)
