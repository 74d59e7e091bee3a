"""Values of parameters as YAML on one line, with the ROS parameter type that they have.

Source: `launch_ros.utilities.evaluate_parameters` (a text is read as YAML unless its type is given), and
`rcl_yaml_param_parser` (types of scalars and arrays).
"""

from __future__ import annotations

import json
import re
from dataclasses import dataclass
from typing import Final

import yaml

from kg.launch.files.ros2.context import HOLE
from kg.yamltext import Walk, compose_yaml, load_yaml

_TEXT: Final = "string"
_NULL: Final = "tag:yaml.org,2002:null"
_INTEGER: Final = re.compile(r"[-+]?(?:0[xX][0-9a-fA-F]+|0[0-7]*|[1-9][0-9]*)")
_DOUBLE: Final = re.compile(
    r"[-+]?(?:(?:[0-9]+\.?[0-9]*|\.[0-9]+)(?:[eE][-+]?[0-9]+)?|\.?inf(?:inity)?|\.?nan)", re.IGNORECASE
)
_BOOLEANS: Final = frozenset(
    written for word in ("y", "yes", "true", "on", "n", "no", "false", "off")
    for written in (word, word.capitalize(), word.upper())
)  # fmt: skip
_TRUTHS: Final = {
    **dict.fromkeys(("true", "1", "yes", "on"), True),
    **dict.fromkeys(("false", "0", "no", "off"), False),
}


@dataclass(frozen=True, slots=True)
class Performed:
    """An item of a list that was a text with substitutions: it is read as YAML."""

    text: str


def truth(text: str) -> bool | None:
    """Return the truth value of a text; None if it has none."""
    return _TRUTHS.get(text.strip().lower())


def of_text(text: str, wanted: str | None = None) -> tuple[str | None, str | None]:
    """Return the value and type of a text as a parameter; None for an unknown text.

    `wanted` is the type asked for; a text stays one where that is `string`, else it is read as YAML.
    """
    if text.strip() == HOLE:
        return None, wanted
    if wanted == _TEXT or HOLE in text:
        return quoted(text), wanted or _TEXT
    try:
        node = compose_yaml(text) if text else None
        value, kind = of_yaml(node) if node is not None else ('""', _TEXT)
    except ValueError:
        return quoted(text), _TEXT
    if wanted == "double" and kind == "int":
        value = f"{value}.0"
    return value, wanted or kind


def of_object(value: object) -> tuple[str | None, str | None]:
    """Return the value and type of a value of Python; None for one that is not known."""
    if isinstance(value, bool):
        return str(value).lower(), "bool"
    if isinstance(value, int):
        return str(value), "int"
    if isinstance(value, float):
        return repr(value), "double"
    if isinstance(value, str):
        return (None, _TEXT) if value.strip() == HOLE else (quoted(value), _TEXT)
    if isinstance(value, list | tuple):
        items = [of_text(item.text) if isinstance(item, Performed) else of_object(item) for item in value]
        written = [HOLE if text is None else text for text, _ in items]
        return f"[{', '.join(written)}]", _array({kind for _, kind in items})
    return None, None


def of_yaml(node: yaml.Node, walk: Walk | None = None, depth: int = 0) -> tuple[str, str | None]:
    """Return the value and type of a node of a document; raises `YamlFault` as `walk` does."""
    walk = walk or Walk()
    walk.visit(node, depth)
    if isinstance(node, yaml.ScalarNode):
        plain = not node.style and "\n" not in node.value
        return (node.value if plain else quoted(node.value, style=node.style)), _type(node)
    if isinstance(node, yaml.SequenceNode):
        items = [of_yaml(item, walk, depth + 1) for item in node.value]
        return f"[{', '.join(text for text, _ in items)}]", _array({kind for _, kind in items})
    pairs = [(of_yaml(key, walk, depth + 1)[0], of_yaml(value, walk, depth + 1)[0]) for key, value in node.value]
    return f"{{{', '.join(f'{key}: {value}' for key, value in pairs)}}}", None


def _type(node: yaml.ScalarNode) -> str | None:
    """Return the type of a scalar as `get_value` of `rcl_yaml_param_parser` decides it; None for null.

    Unlike YAML 1.1 it reads `1e-3` and `-.5` as numbers, `y` as a boolean, and `1_000` and `1:30` as texts.
    """
    if node.style:
        return _TEXT
    if node.tag == _NULL:
        return None
    if node.value in _BOOLEANS:
        return "bool"
    if _INTEGER.fullmatch(node.value):
        return "int"
    return "double" if _DOUBLE.fullmatch(node.value) else _TEXT


def quoted(text: str, *, style: str | None = None) -> str:
    """Return a text as YAML that reads as this text: plain where it can be, unless it was written in quotes."""
    if style or not text or text != text.strip() or "\n" in text or len(text) > 200:  # noqa: PLR2004  (surely no word)
        return json.dumps(text, ensure_ascii=False)
    if all(part.isidentifier() for part in text.split("/") if part) and text.lower() not in _WORDS:
        return text
    try:
        same = load_yaml(text) == text
    except (yaml.YAMLError, ValueError):
        same = False
    return text if same else json.dumps(text, ensure_ascii=False)


_WORDS: Final = {"true", "false", "yes", "no", "on", "off", "null", "~", "/"}


def _array(kinds: set[str | None]) -> str | None:
    if kinds == {"int", "double"}:
        return "double_array"
    kind = next(iter(kinds)) if len(kinds) == 1 else None
    return f"{kind}_array" if kind else None
