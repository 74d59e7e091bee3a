"""Parameters of nodes: dictionaries, files, and values as launch_ros takes them.

Source: `launch_ros.utilities.normalize_parameters`: texts stay texts, substitutions are read as YAML, dictionaries in
dictionaries make dotted names, and a list of texts with a substitution among them is one text.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

from kg.extract.launch.expressions.texts import join, reason_of, to_text, unknown_text
from kg.extract.launch.expressions.values import Choice, Guarded, Items, Substitution, Table, Unknown, Words
from kg.extract.launch.ros2.actions import ParameterFile, ParameterValue
from kg.extract.launch.ros2.python.conditions import condition_of
from kg.extract.launch.ros2.python.values import PathValue

if TYPE_CHECKING:
    from collections.abc import Callable

    from kg.extract.launch.expressions.values import Text, Value
    from kg.extract.launch.ros2.actions import ParameterSource
    from kg.extract.launch.ros2.python.call import Call
    from kg.facts import Location

__all__ = ["PARAMETERS", "Typed", "file_of", "sources_of", "value_of"]

_MAX_DEPTH: Final = 20
_MAX_ENTRIES: Final = 20_000


class Typed:
    """A `ParameterValue`: a value with its type."""

    def __init__(self, value: Value, *, as_text: bool) -> None:
        self.value = value
        self.as_text = as_text


def value_of(name: Text, value: Value, location: Location) -> ParameterValue:
    """Return one parameter."""
    if isinstance(value, Typed):
        if value.as_text:
            return ParameterValue(name, to_text(value.value), location, as_text=True)
        inner = value.value
        if isinstance(inner, str):
            return ParameterValue(name, to_text(inner), location)
        return value_of(name, inner, location)
    if isinstance(value, bool | int | float):
        return ParameterValue(name, value, location)
    if isinstance(value, str):
        return ParameterValue(name, to_text(value), location, as_text=True)
    if isinstance(value, Items | tuple):
        return _list_value(name, list(value), location)
    return ParameterValue(name, to_text(value), location)


def _list_value(name: Text, values: list[Value], location: Location) -> ParameterValue:
    lazy = [item for item in values if isinstance(item, Words | Unknown | Choice | Guarded)]
    if any(isinstance(item, Words) for item in lazy) and all(isinstance(item, Words | str) for item in values):
        return ParameterValue(name, join([part for item in values for part in to_text(item)]), location)
    if any(not isinstance(item, Words) for item in lazy):
        return ParameterValue(name, unknown_text(reason_of(lazy[0])), location)
    found: list[object] = [item if isinstance(item, str | bool | int | float) else to_text(item) for item in values]
    return ParameterValue(name, found, location)


def file_of(value: Value, location: Location) -> ParameterFile:
    """Return a file of parameters; its path is unknown where the value is."""
    return value if isinstance(value, ParameterFile) else ParameterFile(to_text(value), location)


def sources_of(call: Call, value: Value, location: Location) -> tuple[ParameterSource, ...]:
    """Return the parameters that a node gets, in their order."""
    if value is None:
        return ()
    found = call.machine.iterate(value) if not isinstance(value, Table | str) else [value]
    if found is None:
        return (ParameterFile(unknown_text(f"parameters are not known: {reason_of(value)}"), location),)
    places = _places(call, location)
    sources: list[ParameterSource] = []
    for number, item in enumerate(found):
        place = places[number] if number < len(places) and len(places) == len(found) else location
        sources += _source(item, place)
    return tuple(sources)


def _places(call: Call, location: Location) -> list[Location]:
    """Return where the items of the list that is written at the call stand."""
    expression = call.expression("parameters")
    elements = getattr(expression, "elts", [])
    return [call.machine.location(element, call.frame) for element in elements] or [location]


def _source(item: Value, location: Location) -> list[ParameterSource]:
    if isinstance(item, Guarded):
        return [ParameterFile(unknown_text(f"it depends on `{item.condition.written}`"), location)]
    if isinstance(item, Table):
        found: list[ParameterSource] = []
        _enter(found, item, (), location)
        return found
    if isinstance(item, ParameterFile | ParameterValue):
        return [item]
    if isinstance(item, str | Words | PathValue | Items | tuple):
        return [ParameterFile(to_text(item), location)]
    return (
        [] if item is None else [ParameterFile(unknown_text(f"parameters are not known: {reason_of(item)}"), location)]
    )


def _enter(found: list[ParameterSource], table: Table, prefix: Text, location: Location, depth: int = 0) -> None:
    """Add the entries of a dictionary, which may hold the same one many times, to what was found."""
    for key, value in table.items():
        if len(found) >= _MAX_ENTRIES:
            return
        place = table.places.get(key, location)
        name = (*prefix, ".", *to_text(key)) if prefix else to_text(key)
        if isinstance(value, Table) and depth < _MAX_DEPTH:
            _enter(found, value, name, place, depth + 1)
        elif value is not None:
            found.append(value_of(join(list(name)), value, place))
    if table.rest is not None:
        found.append(ParameterFile(unknown_text(f"more parameters: {table.rest.reason}"), location))


def _parameter_file(call: Call) -> Value:
    inner = call.value("param_file", 0)
    substitutions = call.value("allow_substs", None, default=False)
    allowed = substitutions not in {False, "false", "False"} if isinstance(substitutions, bool | str) else True
    made = file_of(inner, call.location)
    return ParameterFile(made.path, call.location, allowed, made.rewrites, made.root, made.keys)


def _typed(call: Call) -> Value:
    kind = call.value("value_type")
    return Typed(call.value("value", 0), as_text=getattr(kind, "path", "") == "builtins.str")


def _parameter(call: Call) -> Value:
    kind = call.value("value_type")
    inner = Typed(call.value("value", 1), as_text=True) if getattr(kind, "path", "") == "builtins.str" else None
    return value_of(call.text("name", 0) or (), inner or call.value("value", 1), call.location)


def _rewritten(call: Call) -> Value:
    """Return nav2's `RewrittenYaml` as the file that it rewrites, with what it does to it."""
    rewrites = _pairs(call, "param_rewrites")
    root = call.value("root_key")
    return ParameterFile(
        call.text("source_file", 0) or (),
        call.location,
        rewrites=rewrites,
        root=None if root is None or root == "" else to_text(root),
        keys=_pairs(call, "key_rewrites"),
    )


def _pairs(call: Call, name: str) -> tuple[tuple[Text, Text], ...]:
    value = call.value(name)
    if isinstance(value, Table):
        return tuple((to_text(key), to_text(item)) for key, item in value.items())
    if value is not None and value != "":
        call.machine.unresolved(f"what a file of parameters is rewritten with: {reason_of(value)}", call.location)
    return ()


def _replaced(call: Call) -> Value:
    """Return nav2's `ReplaceString`: the name of a copy of a file in which texts are replaced."""
    condition = condition_of(call)
    held: Text = ("true",)
    if condition is not None and condition.value is None:
        held = unknown_text(f"it depends on `{condition.words}`")
    elif condition is not None and condition.value is not None:
        held = (Substitution("not", (condition.value,)),) if condition.negated else condition.value
    pairs = _pairs(call, "replacements")
    operands = (to_text(call.value("source_file", 0)), held, *(text for pair in pairs for text in pair))
    return Words((Substitution("replaced-file", operands),), lazy=True)


PARAMETERS: Final[dict[str, Callable[[Call], Value]]] = {
    "ParameterFile": _parameter_file,
    "ParameterValue": _typed,
    "Parameter": _parameter,
    "RewrittenYaml": _rewritten,
    "ReplaceString": _replaced,
}
