"""Parameters of dynamic_reconfigure: `.cfg` files, which are Python programs that add parameters to a generator.

Every `generator.add(name, type, level, description, default, ...)` (of a group, too) is a parameter.
Source: wiki.ros.org/dynamic_reconfigure and its `parameter_generator_catkin`.
"""

from __future__ import annotations

import json
from typing import TYPE_CHECKING, Final

from kg.facts import Access, Location, Parameter, Resolution
from kg.holes import is_partial
from kg.lazily import lazily
from kg.symbolic.values import Number, Text, Truth, TypeValue, Value

if TYPE_CHECKING:
    from collections.abc import Iterator

    from kg.corpus.files import FilePath
    from kg.corpus.reading import Reader
    from kg.extract.python.programs import Called

with lazily():
    from kg.extract.python.programs import calls_of

_TYPES: Final = {"int_t": "int", "double_t": "double", "bool_t": "bool", "str_t": "string"}
_ADD_ARGUMENTS: Final = ("name", "paramtype", "level", "description", "default")
_GENERATE_ARGUMENTS: Final = ("pkgname", "nodename", "name")


def read_configuration(reader: Reader, file: FilePath) -> tuple[Parameter, ...]:
    """Return the parameters of the `.cfg` file; parts that do not parse are a problem KG115 of the `reader`."""
    calls = (call for call in calls_of(reader, file) if call.name == "add")
    return tuple({found.name: found for call in calls for found in _added(call, reader.repository)}.values())


def generates(reader: Reader, file: FilePath, package: str, name: str) -> bool:
    """Check whether a `.cfg` file generates a configuration of a name for a package, "" for any.

    The last call of the file states both: `generator.generate(package, node, name)`.
    """
    for call in calls_of(reader, file):
        given = {**dict(zip(_GENERATE_ARGUMENTS, call.values, strict=False)), **call.named}
        home, stem = (one.exact if isinstance(one := given.get(key), Text) else None for key in ("pkgname", "name"))
        if call.name == "generate" and stem == name and package in {"", home}:
            return True
    return False


def _added(call: Called, repository: str) -> Iterator[Parameter]:
    given = {**dict(zip(_ADD_ARGUMENTS, call.values, strict=False)), **call.named}
    name, kind, description = (given.get(part) for part in ("name", "paramtype", "description"))
    type_name = _TYPES.get(kind.kind.name) if isinstance(kind, TypeValue) else None
    if type_name is not None and isinstance(name, Text) and name.shown:
        other = call.file.repository if call.file.repository != repository else None
        yield Parameter(
            name=name.shown,
            type=type_name,
            default=_default(given.get("default")),
            access=Access.READ,
            location=Location(call.file.path, call.line, other),
            resolution=Resolution.PARTIAL if is_partial(name.shown) else Resolution.LITERAL,
            description=description.exact if isinstance(description, Text) else None,
        )


def _default(value: Value | None) -> str | None:
    """Return a default as YAML; None for one that is not known."""
    if isinstance(value, Text) and value.exact is not None:
        return json.dumps(value.exact)
    if isinstance(value, Truth):
        return str(value.value).lower()
    return value.written if isinstance(value, Number) else None
