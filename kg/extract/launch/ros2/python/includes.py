"""Including other launch files."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

from kg.extract.launch.expressions.texts import reason_of, to_text
from kg.extract.launch.expressions.values import Choice, Guarded, Items, Table, Unknown, Words, pair_of
from kg.extract.launch.ros2.actions import Group, Include
from kg.extract.launch.ros2.python.conditions import condition_of
from kg.extract.launch.ros2.python.flatten import actions_of
from kg.extract.launch.ros2.python.values import Description, PathValue, Source

if TYPE_CHECKING:
    from collections.abc import Callable

    from kg.extract.launch.expressions.values import Text, Value
    from kg.extract.launch.ros2.python.call import Call

__all__ = ["INCLUDES"]


def _source_of(call: Call, value: Value) -> Source:
    if isinstance(value, Source):
        return value
    if isinstance(value, Description):
        return Source(None, actions=tuple(actions_of(call.machine, value, call.location)))
    if isinstance(value, str | Words | PathValue | Items | tuple):
        return Source(to_text(value))
    return Source(None, reason_of(value))


def _source(call: Call) -> Value:
    given = call.first("launch_file_path", "launch_description", "location")
    return _source_of(call, given if given is not None else call.value("", 0))


def _include(call: Call) -> Value:
    given = call.value("launch_description_source", 0)
    if isinstance(given, Choice):
        options = ((condition, _included(call, _source_of(call, each))) for condition, each in given.options)
        return Choice(tuple(options))
    return _included(call, _source_of(call, given))


def _included(call: Call, source: Source) -> Value:
    condition = condition_of(call)
    arguments = _arguments(call)
    if source.actions is not None:
        setters = tuple(arguments)
        group = Group(location=call.location, condition=condition, actions=source.actions, configurations=setters)
        return (
            group
            if setters
            else Group(location=call.location, condition=condition, actions=source.actions, scoped=False)
        )
    return Include(
        location=call.location,
        condition=condition,
        path=source.path,
        arguments=arguments,
        reason=source.reason if source.path is None else None,
    )


def _arguments(call: Call) -> tuple[tuple[Text, Text], ...]:
    """Return `launch_arguments`: pairs, or a dictionary's items."""
    value = call.value("launch_arguments", 1)
    if value is None:
        return ()
    pairs = [(key, item) for key, item in value.items()] if isinstance(value, Table) else call.machine.iterate(value)
    found: list[tuple[Text, Text]] = []
    for item in pairs if pairs is not None else [Unknown(reason_of(value))]:
        pair = pair_of(item.value if isinstance(item, Guarded) else item)
        if pair is None:
            reason = f"arguments of an include are not known: {reason_of(item)}"
            call.machine.unresolved(reason, call.place("launch_arguments", 1))
            continue
        name, given = pair
        found.append((to_text(name), to_text(Unknown(reason_of(item)) if isinstance(item, Guarded) else given)))
    return tuple(found)


INCLUDES: Final[dict[str, Callable[[Call], Value]]] = {
    "IncludeLaunchDescription": _include,
    "PythonLaunchDescriptionSource": _source,
    "AnyLaunchDescriptionSource": _source,
    "FrontendLaunchDescriptionSource": _source,
    "XMLLaunchDescriptionSource": _source,
    "YAMLLaunchDescriptionSource": _source,
    "LaunchDescriptionSource": _source,
}
