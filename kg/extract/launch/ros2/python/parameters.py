"""Parameters of nodes: dictionaries, files, and values as launch_ros takes them.

Source: `launch_ros.utilities.normalize_parameters`: texts stay texts, substitutions are read as YAML, dictionaries in
dictionaries make dotted names, and a list of texts with a substitution among them is one text.
"""

from __future__ import annotations

from itertools import islice
from typing import TYPE_CHECKING, Final

from kg.extract.launch.ros2.actions import ParameterFile, ParameterValue
from kg.extract.launch.ros2.python.substitutions import file_of, is_substitution
from kg.extract.launch.ros2.python.values import Made, guarded, launch_text, reason_of
from kg.extract.launch.ros2.texts import join, unknown_text
from kg.symbolic.operators import NULL, plain
from kg.symbolic.values import Either, Mapping, Number, Sequence, Text, Truth, TypeValue, Unknown, Value

if TYPE_CHECKING:
    from collections.abc import Iterator

    from kg.extract.launch.ros2.actions import ParameterSource
    from kg.extract.launch.ros2.python.reading import Reading
    from kg.extract.launch.ros2.texts import Text as LaunchText
    from kg.facts import Location

__all__ = ["sources_of", "value_of"]

_MAX_DEPTH: Final = 20
_MAX_ENTRIES: Final = 20_000


def value_of(name: LaunchText, value: Value, location: Location) -> ParameterValue:
    """Return one parameter."""
    if isinstance(value, Made) and value.name in ("ParameterValue", "Parameter"):
        kind, inner = value.fields.get("value_type"), value.fields.get("value", NULL)
        is_text = isinstance(kind, TypeValue) and kind.kind.names == ("builtins", "str")
        if is_text or isinstance(inner, Text):
            return ParameterValue(name, launch_text(inner), location, as_text=is_text)
        return value_of(name, inner, location)
    if isinstance(value, Number | Truth):
        return ParameterValue(name, _plain(value), location)
    if isinstance(value, Text):
        return ParameterValue(name, launch_text(value), location, as_text=value.known is not None)
    if isinstance(value, Sequence):
        return _list_value(name, list(value.items), location)
    return ParameterValue(name, launch_text(value), location)


def _plain(value: Value) -> bool | float:
    found = plain(value)
    return found if isinstance(found, bool | int | float) else 0


def _is_later(value: Value) -> bool:
    return is_substitution(value) or (isinstance(value, Text) and value.known is None)


def _list_value(name: LaunchText, values: list[Value], location: Location) -> ParameterValue:
    unknown = next((item for item in values if isinstance(item, Unknown | Either)), None)
    if any(map(_is_later, values)) and all(_is_later(item) or isinstance(item, Text) for item in values):
        return ParameterValue(name, join([part for item in values for part in launch_text(item)]), location)
    if unknown is not None:
        return ParameterValue(name, unknown_text(reason_of(unknown)), location)
    known = (plain(item) for item in values)
    found = [launch_text(item) if one is None else one for item, one in zip(values, known, strict=True)]
    return ParameterValue(name, list(found), location)


def sources_of(reading: Reading, made: Made) -> tuple[ParameterSource, ...]:
    """Return the parameters that a node gets, in their order."""
    value, location = made.value("parameters"), made.place("parameters")
    if value is None:
        return ()
    whole = isinstance(value, Mapping) or (isinstance(value, Text) and value.known is not None)
    found = [(value, ())] if whole else reading.machine.items(value)
    if found is None:
        return (ParameterFile(unknown_text(f"parameters are not known: {reason_of(value)}"), location),)
    places = reading.places_of(value, len(found), location)
    sources: list[ParameterSource] = []
    for (item, terms), place in zip(found, places, strict=True):
        if terms:
            words = terms[0].lstrip("!?")
            sources.append(ParameterFile(unknown_text(f"it depends on `{words}`"), place))
        else:
            sources += _source(reading, item, place)
    return tuple(sources)


def _source(reading: Reading, item: Value, location: Location) -> list[ParameterSource]:
    if isinstance(item, Mapping):
        return list(islice(_entries(reading, item, (), location), _MAX_ENTRIES))
    if isinstance(item, Made) and item.name == "Parameter":
        return [value_of(item.text("name") or (), item, item.location)]
    if isinstance(item, Sequence | Text) or is_substitution(item):
        return [file_of(item, location)]
    if item == NULL:
        return []
    return [ParameterFile(unknown_text(f"parameters are not known: {reason_of(item)}"), location)]


def _entries(
    reading: Reading, table: Mapping, prefix: LaunchText, location: Location, depth: int = 0
) -> Iterator[ParameterSource]:
    """Yield the entries of a dictionary, which may hold the same one many times."""
    for key, value in table.items:
        place = reading.place_of(key) or location
        name = join([*prefix, *([".", *launch_text(key)] if prefix else launch_text(key))])
        item, terms = guarded(value)
        if terms:
            yield ParameterValue(name, unknown_text(reason_of(value)), place)
        elif isinstance(item, Mapping) and depth < _MAX_DEPTH:
            yield from _entries(reading, item, name, place, depth + 1)
        elif item != NULL:
            yield value_of(name, item, place)
    if table.open:
        yield ParameterFile(unknown_text("more parameters: it is not known what a dictionary has"), location)
