"""Reading a ROS 2 launch file in Python without running it: what `generate_launch_description()` returns.

The file is interpreted over values of which some are not known; nothing of it is executed, nothing but files of the
build is read, and the work is bounded. Sources: the packages `launch` and `launch_ros` of ROS 2.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

from kg.extract.launch.ros2.python.reading import Reading
from kg.extract.launch.ros2.python.source import Broken, parse
from kg.facts import LaunchProblemKind
from kg.symbolic.operators import NULL
from kg.symbolic.values import Closure, Sequence, TypeValue, Unknown

if TYPE_CHECKING:
    from collections.abc import Sequence as Items

    from kg.corpus.files import FilePath
    from kg.extract.launch.files import Files
    from kg.extract.launch.ros2.actions import Action
    from kg.extract.python.units import PythonUnit
    from kg.facts import LaunchProblem
    from kg.symbolic.values import Value

__all__ = ["read_python"]

_ENTRIES: Final = ("generate_launch_description", "generate_test_description")


def read_python(files: Files, file: FilePath, text: bytes, problems: list[LaunchProblem]) -> Items[Action]:
    """Return the actions that a launch file describes; what is wrong or not known is added to `problems`.

    Bodies of `OpaqueFunction`s are read when their actions are executed, and may add problems then.
    """
    reading = Reading(files, file, problems)
    unit = parse(file, text)
    if isinstance(unit, Broken):
        reading.note(LaunchProblemKind.MALFORMED, unit.message, reading.at(file, unit.line))
        return []
    names = [child for child in unit.root.named_children if child.type == "function_definition"]
    lines = (
        int(node.start_point[0]) + 1
        for node in names
        if (name := node.child_by_field_name("name")) is not None and (name.text or b"").decode() in _ENTRIES
    )
    location = reading.at(file, next(lines, 1))
    return reading.bounded(lambda: _described(reading, unit), location)


def _described(reading: Reading, unit: PythonUnit) -> Value:
    """Return what the file's function returns."""
    module = reading.language.module(unit)
    function = next((module.fields[name] for name in _ENTRIES if name in module.fields), None)
    if function is None:
        message = f"the file has no function `{_ENTRIES[0]}`"
        reading.note(LaunchProblemKind.MALFORMED, message, reading.location)
        return NULL
    if not isinstance(function, Closure | TypeValue):
        return Unknown(f"`{_ENTRIES[0]}` is no function that can be read")
    found = reading.called(function, [])
    test = isinstance(found, Sequence) and _ENTRIES[1] in module.fields and found.items
    return found.items[0] if test and isinstance(found, Sequence) else found
