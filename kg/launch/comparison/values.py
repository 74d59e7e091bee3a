"""Values of parameters and arguments as they are compared: `30.` and `30.0` are one number."""

from __future__ import annotations

import json
import re
from typing import Any, Final

import yaml

from kg.yamltext import load_yaml

__all__ = ["canonical"]

_EXPONENT: Final = re.compile(r"[-+]?(\d+\.?\d*|\.\d+)[eE][-+]?\d+")
"""A number for C++ and for ROS, a text for YAML 1.1 where it lacks the point or the sign."""
_LONGEST: Final = 10_000


def canonical(text: str) -> str:
    """Return a value written as YAML in the one spelling of all texts that mean it; others are returned as they are.

    An integer is another value than the same floating point number: a parameter of ROS 2 has a type.
    """
    if len(text) > _LONGEST:
        return text
    if _EXPONENT.fullmatch(text.strip()):
        return repr(float(text))
    return _written(_read(text), text)


def _written(value: Any, text: str) -> str:
    if isinstance(value, str):
        return value if _read(value) == value else json.dumps(value, ensure_ascii=False)
    if isinstance(value, bool | int | float | list | dict):
        try:
            return json.dumps(value, ensure_ascii=False, sort_keys=True)
        except (TypeError, ValueError):  # dates, keys of several types
            return text
    return text


def _read(text: str) -> Any:
    try:
        return load_yaml(text, yaml.SafeLoader)
    except (yaml.YAMLError, ValueError, RecursionError):
        return text
