"""`IncludeLaunchDescription`: another launch file, of any dialect, executed in the settings of this one.

What the file sets stays set behind the include, unless a scoped group stands around it.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

from kg.extract.launch.ros2.actions import DeclareArgument
from kg.extract.launch.ros2.context import HOLE
from kg.extract.launch.ros2.locate import find
from kg.extract.launch.ros2.read import dialect_by_ending, read_actions
from kg.facts import LaunchInclude, LaunchProblemKind
from kg.wiring.similar import alike, alike_when_short

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from kg.corpus.files import FilePath
    from kg.extract.launch.ros2.actions import Action, Include
    from kg.extract.launch.ros2.context import Context

__all__ = ["include"]

_MOST_DEPTH: Final = 100
_MOST_INCLUDES: Final = 5_000


def include(context: Context, action: Include, run: Callable[[Sequence[Action]], None]) -> None:
    """Execute the file of an include with `run`; note it as an include whether there is such a file or not."""
    if len(context.found.includes) >= _MOST_INCLUDES:
        context.problem(LaunchProblemKind.LIMIT, f"more than {_MOST_INCLUDES} files are included")
        return
    written = HOLE if action.path is None else context.perform(action.path)
    reason = action.reason if action.path is None else None
    if HOLE in written:
        context.unresolved(f"which file is included is not known: {reason or f'`{written}`'}", written)
    file = find(context, written)
    context.found.includes.append(
        LaunchInclude(
            written,
            context.location,
            context.chain,
            file.repository if file else None,
            file.path if file else None,
            " and ".join(context.conditions) or None,
            None if file else reason or "there is no such file, or it cannot be known which",
        )
    )
    if file is not None and _may_enter(context, file):
        _enter(context, action, file, run)


def _may_enter(context: Context, file: FilePath) -> bool:
    if file in context.stack:
        context.problem(LaunchProblemKind.CYCLE, f"`{file.path}` includes itself", file.path)
        return False
    if len(context.stack) > _MOST_DEPTH:
        context.problem(
            LaunchProblemKind.LIMIT, f"files include each other deeper than {_MOST_DEPTH} levels", file.path
        )
        return False
    return True


def _enter(context: Context, action: Include, file: FilePath, run: Callable[[Sequence[Action]], None]) -> None:
    arguments = _arguments(context, action, file)
    actions = read_actions(context, file, dialect_by_ending(file))
    given = {name for name, _ in arguments}
    context.scope.configurations.update(arguments)
    for inner in actions:
        if isinstance(inner, DeclareArgument) and inner.condition is None and inner.default is None:
            _require(context, inner.name, given, file)
    _misspelt(context, given, {one.name for one in actions if isinstance(one, DeclareArgument)}, file)
    with context.inside(file):
        run(actions)


def _arguments(context: Context, action: Include, file: FilePath) -> list[tuple[str, str]]:
    """Return the arguments of an include; launch performs them when the file included is already the current one."""
    own, context.file = context.file, file
    try:
        return [(context.perform(name), context.perform(value)) for name, value in action.arguments]
    finally:
        context.file = own


def _misspelt(context: Context, given: set[str], declared: set[str], file: FilePath) -> None:
    """Note an argument that the file does not declare, where it declares one of a like name that is not passed.

    Launch takes arguments that nothing declares.
    """
    for name in sorted(given - declared):
        like = next((one for one in sorted(declared - given) if alike(name, one) or alike_when_short(name, one)), None)
        if like is not None and HOLE not in name:
            message = f"`{file.path}` declares no argument `{name}`, but `{like}`, which the include does not pass"
            context.problem(LaunchProblemKind.UNDECLARED_ARGUMENT, message, name)


def _require(context: Context, name: str, given: set[str], file: FilePath) -> None:
    """Note an argument without default that the include itself does not pass; launch asks for that."""
    if name not in given:
        message = f"`{file.path}` needs the argument `{name}`, which the include does not pass"
        context.problem(LaunchProblemKind.MISSING_ARGUMENT, message, name)
        context.scope.configurations.setdefault(name, HOLE)
