"""Values and names as roslaunch builds them: what a text means by its type, and a value as YAML in one line.

Source: wiki.ros.org/roslaunch/XML/param, and for what `auto` means roslaunch's loader.
"""

from __future__ import annotations

import datetime as dt
import json
import re
from typing import Final

import yaml

from kg.extract.launch.expressions import HOLE
from kg.holes import ANONYMOUS

__all__ = [
    "HOLE",
    "MOST_CHARACTERS",
    "automatic",
    "canonical",
    "converted",
    "global_namespace",
    "join",
    "one_line",
    "shown",
    "truth",
    "type_of",
]

MOST_CHARACTERS: Final = 1 << 16
"""Of one text after substitution; arguments that repeat each other double with each line."""

_ROSLAUNCH: Final = "/roslaunch/"
"""The node that sets parameters; a private name that reaches the server is private to it."""


def shown(text: str) -> str:
    """Return the text as facts have it, with `{}` for what is not known."""
    return text.replace(HOLE, ANONYMOUS)


def join(namespace: str, name: str) -> str:
    """Return `name` in a namespace (with or without a slash at its end); private and global names keep their own."""
    if name.startswith(("~", "/")) or not namespace:
        return name
    return f"~{name}" if namespace == "~" else f"{namespace.rstrip('/')}/{name}"


def canonical(name: str) -> str:
    """Return an absolute name with single slashes and none at its end, as the parameter server has it."""
    rooted = f"{_ROSLAUNCH}{name[1:]}" if name.startswith("~") else name
    return "/" + "/".join(part for part in rooted.split("/") if part)


def global_namespace(name: str) -> str:
    """Return a namespace as an absolute one with a slash at its end."""
    inner = canonical(name)
    return inner if inner == "/" else f"{inner}/"


_PLAIN: Final = re.compile(r"[A-Za-z_/][\w./-]*(?: [\w./-]+)*", re.ASCII)
_RESOLVER: Final = yaml.resolver.Resolver()
_TEXT: Final = "tag:yaml.org,2002:str"
_BOOLEANS: Final = {"true": True, "1": True, "false": False, "0": False}
_SCALARS: Final = ((bool, "bool"), (int, "int"), (float, "double"), (str, "string"))


def automatic(text: str) -> bool | int | float | str:
    """Return the value that roslaunch guesses: a number, a boolean, else the text."""
    try:
        if "." in text:
            return float(text)
        if "_" not in text:
            return int(text)
    except ValueError:
        pass
    lower = text.lower()
    return lower == "true" if lower in {"true", "false"} else text


def truth(text: str) -> bool:
    """Return what roslaunch takes a text of an `if` for; ValueError when it takes it for nothing."""
    value = _BOOLEANS.get(text.lower().strip())
    if value is None:
        raise ValueError(f"'{text}' is neither true nor false")
    return value


def converted(text: str, kind: str) -> object:
    """Return the value of a text of the type `kind` (`auto`, `str`, `int`, `double`, `bool`), else ValueError."""
    if kind == "auto":
        return automatic(text)
    if kind in {"str", "string"}:
        return text
    if kind == "int":
        return int(text)
    if kind == "double":
        return float(text)
    if kind in {"bool", "boolean"}:
        return truth(text)
    raise ValueError(f"'{kind}' is no type of a parameter")


def type_of(value: object) -> str | None:
    """Return the ROS type of a value: `bool`, `int`, `double`, `string`, `int_array`, ...; None for null."""
    if isinstance(value, list):
        kinds = {type_of(item) for item in value}
        if kinds == {"int", "double"}:
            return "double_array"
        return f"{kinds.pop()}_array" if len(kinds) == 1 and kinds <= {name for _, name in _SCALARS} else "array"
    if isinstance(value, dict):
        return "struct"
    if isinstance(value, bytes):
        return "base64"
    if isinstance(value, dt.date):
        return "date"
    return next((name for kind, name in _SCALARS if isinstance(value, kind)), None)


def one_line(value: object) -> str:
    """Return a value as YAML in one line that means the same."""
    if value is None:
        return "null"
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, float):
        return _float(value)
    if isinstance(value, list):
        return f"[{', '.join(map(one_line, value))}]"
    if isinstance(value, dict):
        return f"{{{', '.join(f'{one_line(key)}: {one_line(item)}' for key, item in value.items())}}}"
    return _string(value) if isinstance(value, str) else str(value)


def _float(value: float) -> str:
    if value != value:  # noqa: PLR0124 - this is what makes a number none
        return ".nan"
    if value in {float("inf"), float("-inf")}:
        return ".inf" if value > 0 else "-.inf"
    mantissa, exponent, power = repr(value).partition("e")
    # YAML 1.1 takes `1e-05` for a string
    return f"{mantissa}.0e{power}" if exponent and "." not in mantissa else f"{mantissa}{exponent}{power}"


def _string(text: str) -> str:
    tag = _RESOLVER.resolve(yaml.ScalarNode, text, (True, False))  # type: ignore[no-untyped-call]  # has no types
    return text if tag == _TEXT and _PLAIN.fullmatch(text) else json.dumps(text, ensure_ascii=False)
