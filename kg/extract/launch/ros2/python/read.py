"""Reading a ROS 2 launch file in Python without running it: what `generate_launch_description()` returns.

The file is interpreted over values of which some are not known; nothing of it is executed, nothing but files of the
build is read, and the work is bounded. Sources: the packages `launch` and `launch_ros` of ROS 2.
"""

from __future__ import annotations

import ast
from typing import TYPE_CHECKING, Final

from kg.extract.launch.expressions.containers import Halt
from kg.extract.launch.expressions.values import Frame, Function, Library, Module, Unknown
from kg.extract.launch.ros2.python.flatten import actions_of
from kg.extract.launch.ros2.python.invoke import Invocations
from kg.extract.launch.ros2.python.source import Broken, parse
from kg.facts import LaunchProblem, LaunchProblemKind

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from kg.corpus.files import FilePath
    from kg.extract.launch.expressions.values import Value
    from kg.extract.launch.files import Files
    from kg.extract.launch.ros2.actions import Action
    from kg.extract.launch.ros2.context import Context
    from kg.facts import Location

__all__ = ["read_python"]

_ENTRIES: Final = ("generate_launch_description", "generate_test_description")
_TOO_MUCH: Final = "the file needs more steps to be read than are allowed"


class _Reading(Invocations):
    """The interpreter, at work on one file."""

    def __init__(self, files: Files, problems: list[LaunchProblem]) -> None:
        super().__init__(files, problems)
        self.modules = {}

    def within(self, context: Context, body: Callable[[], Value], location: Location) -> Sequence[Action]:
        """Return the actions of an `OpaqueFunction`, whose body is read in the context of the moment."""
        before, self.context = self.context, context
        self.steps = 0
        try:
            return self.bounded(body, location)
        finally:
            if before is None:
                self.restore()
            self.context = before

    def bounded(self, body: Callable[[], Value], location: Location) -> Sequence[Action]:
        """Return the actions that a value stands for; none where it cannot be found within the bounds."""
        depth, height = self.depth, len(self.guards)
        try:
            return actions_of(self, body(), location)
        except Halt:
            self.note(LaunchProblemKind.LIMIT, _TOO_MUCH, location)
        except RecursionError:
            self.note(LaunchProblemKind.LIMIT, "the file is nested too deeply to be read", location)
        finally:
            self.depth = depth
            del self.guards[height:]
        return []


def read_python(files: Files, file: FilePath, text: bytes, problems: list[LaunchProblem]) -> Sequence[Action]:
    """Return the actions that a launch file describes; what is wrong or not known is added to `problems`.

    Bodies of `OpaqueFunction`s are read when their actions are executed, and may add problems then.
    """
    reading = _Reading(files, problems)
    tree = parse(text)
    if isinstance(tree, Broken):
        reading.note(LaunchProblemKind.MALFORMED, tree.message, reading.at(file, tree.line))
        return []
    module = Module(file, "launch")
    reading.modules[file] = module
    module.scope.names.update({"__file__": files.text(file), "__name__": "launch"})
    entry = next((each for each in ast.walk(tree) if getattr(each, "name", None) in _ENTRIES), tree)
    location = reading.at(file, getattr(entry, "lineno", 1))
    return reading.bounded(lambda: _described(reading, tree, module, location), location)


def _described(reading: _Reading, tree: ast.Module, module: Module, location: Location) -> Value:
    """Return what the file's function returns."""
    reading.run_module(tree, module)
    names = module.scope.names
    function = next((names[name] for name in _ENTRIES if name in names), None)
    if function is None:
        message = f"the file has no function `{_ENTRIES[0]}`"
        reading.note(LaunchProblemKind.MALFORMED, message, location)
        return None
    if not isinstance(function, Function | Library):
        return Unknown(f"`{_ENTRIES[0]}` is no function that can be read")
    found = reading.invoke(function, [], {}, ast.Constant(None, lineno=location.line), Frame(module, module.scope))
    return found[0] if isinstance(found, tuple) and found else found
