"""YAML and JSON that a launch file loads itself: values with the line of each entry."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

import yaml

from kg.extract.launch.expressions.containers import hashable
from kg.extract.launch.expressions.values import Unknown
from kg.yamltext import compose_yaml

if TYPE_CHECKING:
    from collections.abc import Callable

    from kg.extract.launch.expressions.values import Value
    from kg.extract.launch.ros2.python.machine import Machine
    from kg.facts import Location

__all__ = ["construct", "read_yaml"]

_LOADER: Final = getattr(yaml, "CSafeLoader", yaml.SafeLoader)


def read_yaml(machine: Machine, text: str, place: Callable[[int], Location]) -> Value:
    """Return what `yaml.safe_load` gives; `place` makes a location of a line. Aliases are followed within bounds."""
    try:
        node = compose_yaml(text, _LOADER)
        return _value(machine, node, place, yaml.SafeLoader("")) if node is not None else None
    except (yaml.YAMLError, ValueError, RecursionError):
        return Unknown("a YAML text is not valid")


def _value(machine: Machine, node: yaml.Node, place: Callable[[int], Location], loader: yaml.SafeLoader) -> Value:
    machine.step()
    if isinstance(node, yaml.MappingNode):
        table = machine.table()
        for key_node, value_node in node.value:
            key = _value(machine, key_node, place, loader)
            if hashable(key):
                line = place(key_node.start_mark.line + 1)
                table.put(key, _value(machine, value_node, place, loader), line)
        return table
    if isinstance(node, yaml.SequenceNode):
        return machine.items(_value(machine, each, place, loader) for each in node.value)
    found: Value = loader.construct_object(node)
    return found if found is None or isinstance(found, str | bool | int | float) else str(node.value)


def construct(machine: Machine, value: Value) -> Value:
    """Return plain values of Python as those of the interpreter."""
    machine.step()
    if isinstance(value, dict):
        table = machine.table()
        for key, item in value.items():
            table.put(key, construct(machine, item), None)
        return table
    if isinstance(value, list):
        return machine.items(construct(machine, item) for item in value)
    return value
