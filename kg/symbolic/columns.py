"""The columns of descriptions of framework calls, and the words that they take; docs/calls.md explains them."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Final, NamedTuple

from kg.facts import Role

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping

ACCESSES: Final = ("reads", "writes", "declares")
MOST_ARGUMENTS: Final = 99
"""The number of arguments that a call can have if its description gives none."""
_VERSIONS: Final = (0, 1, 2)
LANGUAGES: Final = ("cpp", "python")
_NODES: Final = ("first handle", "handle", "interfaces", "host")


class Form(NamedTuple):
    """The values of a column: `wanted` completes "it must be ..."."""

    wanted: str
    fits: Callable[[Any], bool]


def _is_index(value: object) -> bool:
    return isinstance(value, int) and not isinstance(value, bool) and value >= 0


def _is_text(value: object) -> bool:
    return isinstance(value, str) and value != ""


def _are_texts(value: object) -> bool:
    return isinstance(value, list) and all(map(_is_text, value))


def _are_indexes(value: object) -> bool:
    return isinstance(value, list) and len(value) == 2 and all(map(_is_index, value))  # noqa: PLR2004 - a pair


def _are_tables(value: object) -> bool:
    return isinstance(value, dict) or (isinstance(value, list) and all(isinstance(one, dict) for one in value))


def _are_namespaces(value: object) -> bool:
    return isinstance(value, dict) and all(isinstance(one, str) for one in value.values())


_INDEX: Final = Form("the number of an argument, from 0", _is_index)
_COUNT: Final = Form("a whole number", _is_index)
_TEXT: Final = Form('a text: "name"', _is_text)
_TEXTS: Final = Form('a list of texts: ["name"]', _are_texts)
_NAMES: Final = Form("a text or a list of texts", lambda value: _is_text(value) or (_are_texts(value) and value != []))
_FLAG: Final = Form("true or false", lambda value: isinstance(value, bool))
_COUNTS: Final = Form(
    "the fewest and the most arguments: [1, 2]", lambda value: _are_indexes(value) and value == sorted(value)
)
_TABLES: Final = Form("a table of arguments, { name = 0 }, or a list of them", _are_tables)
_COMMON: Final[Mapping[str, Form]] = {
    "name": _NAMES,
    "ros": Form("0, 1 or 2", lambda value: value in _VERSIONS and not isinstance(value, bool)),
    "arguments": _COUNTS,
    "parameters": _TEXTS,
    "node": Form(
        'the number of an argument, "first handle", "handle", "interfaces" or "host"',
        lambda value: _is_index(value) or value in _NODES,
    ),
    "node_name": _INDEX,
    "mark": _TEXT,
    "slot": Form('a table: { base = "acme::Filter", class = 0 }', lambda value: isinstance(value, dict)),
    **dict.fromkeys((*(role.value for role in Role), *ACCESSES), _TABLES),
}
FILE: Final[Mapping[str, Form]] = {
    "ros": _COMMON["ros"],
    "language": Form('"cpp" or "python"', lambda value: value in LANGUAGES),
    "silent_methods": _TEXTS,
}
"""The keys of a file, beside its rows."""
CALL: Final[Mapping[str, Form]] = {
    **_COMMON,
    "on": _TEXTS,
    "in": _TEXTS,
    "returns": _TEXT,
    "copies": Form("the arguments that the call copies from and to: [0, 1]", _are_indexes),
    "options": _FLAG,
    "loads": _FLAG,
    "creates": _INDEX,
    "registers": _INDEX,
    "port": Form("a table: { name = 0, output = 1 }", lambda value: isinstance(value, dict)),
}
"""The columns of `[[call]]`."""
CLASS: Final[Mapping[str, Form]] = {
    **_COMMON,
    "is": _TEXT,
    "like": _TEXT,
    "replaces": _FLAG,
    "runs": _TEXTS,
    "members": Form('namespaces by member: { pnh_ = "~" }', _are_namespaces),
    "gives": Form("a list of tables with `method`, `arguments` and `handles`", _are_tables),
    "options": _FLAG,
    "unless": _INDEX,
    "namespace": _INDEX,
    "detail": _INDEX,
    "under": _INDEX,
}
"""The columns of `[[class]]`."""
GIVES: Final[Mapping[str, Form]] = {
    "method": _TEXT,
    "arguments": _COUNT,
    "handles": Form(
        'namespaces by argument: { 1 = "~" }',
        lambda value: _are_namespaces(value) and all(key.isdecimal() for key in value),
    ),
}
"""The keys of `gives`."""
SLOT: Final[Mapping[str, Form]] = {
    "base": _TEXT,
    "class": _INDEX,
    "name": _INDEX,
    "parameter": _TEXT,
    "names": _TEXT,
    "module": _INDEX,
    "reason": _TEXT,
}
"""The keys of `slot`."""
PORT: Final[Mapping[str, Form]] = {"name": _INDEX, "default": _INDEX, "output": _INDEX}
"""The keys of `port`."""
_EFFECT: Final[Mapping[str, Form]] = {"name": _INDEX, "fixed": _TEXT}
INTERFACE: Final[Mapping[str, Form]] = {
    **_EFFECT,
    "type": _TEXTS,
    "qos": _INDEX,
    "depth": _COUNT,
    "camera": _FLAG,
    "transport": _INDEX,
    "specification": Form(
        'the number of an argument, or "template"', lambda value: _is_index(value) or value == "template"
    ),
}
"""The keys of an interface."""
PARAMETER: Final[Mapping[str, Form]] = {
    **_EFFECT,
    "type": _TEXTS,
    "value": Form("a text, a number or a truth value", lambda value: isinstance(value, str | int | float)),
    "default": _INDEX,
    "output": _INDEX,
    "prefix": Form("the number of an argument or a text", lambda value: _is_index(value) or _is_text(value)),
    "listed": _FLAG,
    "descriptor": _INDEX,
    "weak": _FLAG,
}
"""The keys of a parameter."""

INDEX: Final = "N"
SECONDS: Final = "SECONDS"
KINDS: Final[Mapping[str, str]] = {
    **dict.fromkeys(("node", "handle", "carrier", "qos", "pair"), ""),
    "value": INDEX,
    "duration": SECONDS,
}
"""The words of `is`, each with what follows its colon."""
RESULTS: Final[Mapping[str, str]] = {
    **dict.fromkeys(("parameter", "is set", "path", "namespace", "own namespace", "own prefix"), ""),
    **dict.fromkeys(("node name", "host", "self"), ""),
    **dict.fromkeys(("is declared", "automatic", "argument", "private", "resolved", "sub node", "camera info"), INDEX),
    **dict.fromkeys(("format", "listed", "package"), INDEX),
    "handle": "NAMESPACE",
    "duration": SECONDS,
}
"""The words of `returns`."""
TYPES: Final[Mapping[str, str]] = {
    **dict.fromkeys(("template", "receiver"), ""),
    **dict.fromkeys(("callback", "options", "text", "argument"), INDEX),
}
"""The words of `type`."""
