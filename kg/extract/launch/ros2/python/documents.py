"""YAML and JSON that a launch file loads itself: values with the line of each entry."""

from __future__ import annotations

import json
from typing import TYPE_CHECKING, Final

import yaml

from kg.symbolic.operators import NULL
from kg.symbolic.values import Mapping, Number, Sequence, Text, Truth, Unknown, Value
from kg.yamltext import compose_yaml

if TYPE_CHECKING:
    from kg.corpus.files import FilePath
    from kg.extract.launch.ros2.python.machine import LaunchMachine

__all__ = ["read_json", "read_yaml"]

_LOADER: Final = getattr(yaml, "CSafeLoader", yaml.SafeLoader)


def read_yaml(machine: LaunchMachine, text: str, file: FilePath | None) -> Value:
    """Return what `yaml.safe_load` gives; keys remember their lines of the file. Aliases are followed within bounds."""
    try:
        node = compose_yaml(text, _LOADER)
        return _value(machine, node, file, yaml.SafeLoader("")) if node is not None else NULL
    except (yaml.YAMLError, ValueError, RecursionError):
        return Unknown("a YAML text is not valid")


def _value(machine: LaunchMachine, node: yaml.Node, file: FilePath | None, loader: yaml.SafeLoader) -> Value:
    machine.step()
    if isinstance(node, yaml.MappingNode):
        entries: dict[Value, tuple[Value, Value]] = {}
        for key_node, value_node in node.value:
            key = _value(machine, key_node, file, loader)
            if isinstance(key, Text | Number | Truth):
                if file is not None:
                    machine.place(key, file, key_node.start_mark.line + 1)
                entries[key] = key, _value(machine, value_node, file, loader)
        return Mapping(tuple(entries.values()))
    if isinstance(node, yaml.SequenceNode):
        return Sequence(tuple(_value(machine, each, file, loader) for each in node.value))
    found: object = loader.construct_object(node)
    return _constructed(machine, found if found is None or isinstance(found, str | bool | int | float) else node.value)


def read_json(machine: LaunchMachine, text: str) -> Value:
    """Return what `json.loads` gives."""
    try:
        return _constructed(machine, json.loads(text))
    except (ValueError, RecursionError):
        return Unknown("a JSON text is not valid")


def _constructed(machine: LaunchMachine, value: object) -> Value:
    """Return plain values of Python as those of the interpreter."""
    machine.step()
    if isinstance(value, dict):
        return Mapping(tuple((Text.of(str(key)), _constructed(machine, item)) for key, item in value.items()))
    if isinstance(value, list):
        return Sequence(tuple(_constructed(machine, item) for item in value))
    if isinstance(value, bool):
        return Truth(value)
    if isinstance(value, int | float):
        return Number(value, repr(value))
    return NULL if value is None else Text.of(str(value))
