"""The C++ class `ParamListener` that `generate_parameter_library` makes of a YAML file.

A node has the parameters of the file if it constructs this class, so the C++ front end reads the header that the tool
would generate, reduced to what the construction does. The declaration of each parameter is on the line of its key in
the YAML file. `ontology/calls/rclcpp.toml` describes `generate_parameter_library::declare`, and `document` for a
key whose type is `none`: other code reads that parameter.
"""

from __future__ import annotations

import json
from typing import Any, Final

import yaml

from kg.extract.parameters.attaching import parse_generated
from kg.holes import Hole, parse

_TYPES: Final = {"bool": "bool", "int": "int64_t", "double": "double", "string": "std::string"}
_CLASS: Final = """class ParamListener { public: Params params_; Params get_params() { return params_; } \
bool try_get_params(Params & params) { params = params_; return true; } \
bool try_update_params(Params & params) { params = params_; return true; } \
template <typename N> ParamListener(N node, rclcpp::Logger, const std::string & prefix = "") \
: ParamListener(node, prefix) {} \
template <typename N> ParamListener(N node, const std::string & prefix = "") { """


def listener(content: bytes, path: str) -> bytes:
    """Return the header for the YAML file at `path`, as UTF-8; empty if the file has not exactly one top key."""
    library = parse_generated(content, path)
    if not library.namespace:
        return b""
    groups: dict[str, Any] = {}
    lines = [""] * max((parameter.location.line for parameter in library.parameters), default=1)
    for parameter in library.parameters:
        name, kind = parameter.name or "", _cpp_type(parameter.type)
        pieces = (json.dumps(part) if isinstance(part, str) else _value(part) for part in parse(name))
        spelled = " + ".join(pieces)
        if kind is None:
            lines[parameter.location.line - 1] += f"generate_parameter_library::document(node, {spelled}, prefix);"
            continue
        default = _literal(yaml.safe_load(parameter.default)) if parameter.default is not None else None
        arguments = [spelled, "prefix", default] if default is not None else [spelled, "prefix"]
        statement = f"generate_parameter_library::declare<{kind}>(node, {', '.join(arguments)});"
        *outer, last = name.split(".")
        if all(part.isidentifier() for part in (*outer, last)):
            group = groups
            for part in outer:
                group = group.setdefault(part, {})
            group[last] = kind
            statement = f"params_.{name} = {statement}"
        lines[parameter.location.line - 1] += statement
    lines[0] = f"namespace {library.namespace} {{ struct Params {{ {_members(groups)} }}; {_CLASS}{lines[0]}"
    return "\n".join([*lines, "} }; }"]).encode()


def _value(part: Hole) -> str:
    """Return an expression that no source defines, with the label of an unknown part as its name."""
    return f"value_at_run_time::{part.label}" if part.label.isidentifier() else "value_at_run_time"


def _cpp_type(kind: str | None) -> str | None:
    element, _, array = (kind or "").partition("_")
    type_name = _TYPES.get(element)
    return f"std::vector<{type_name}>" if array and type_name is not None else type_name


def _members(groups: dict[str, Any]) -> str:
    members = (
        f"struct {name.title()} {{ {_members(inner)} }}; {name.title()} {name};"
        if isinstance(inner, dict)
        else f"{inner} {name};"
        for name, inner in groups.items()
    )
    return " ".join(members)


def _literal(value: object) -> str | None:
    """Return a value as an expression of C++; None for what has no literal, such as infinity."""
    if isinstance(value, bool):
        return str(value).lower()
    if isinstance(value, int | float):
        return repr(value) if value - value == 0 else None
    if isinstance(value, str):
        return json.dumps(value, ensure_ascii=False)
    if isinstance(value, list):
        items = [_literal(item) for item in value]
        return None if None in items else f"{{{', '.join(str(item) for item in items)}}}"
    return None
