"""Canonical values of parameters and arguments: `30.` and `30.0` are one number."""

from __future__ import annotations

import json
import re
from typing import Any, Final

import yaml

from kg.yamltext import load_yaml

_EXPONENT: Final = re.compile(r"[-+]?(\d+\.?\d*|\.\d+)[eE][-+]?\d+")
"""A number for C++ and for ROS, a text for YAML 1.1 where it lacks the point or the sign."""
_LONGEST: Final = 10_000


def canonical(text: str) -> str:
    """Return the canonical spelling of a value written as YAML; other texts are returned unchanged.

    An integer differs from the equal floating point number, because parameters of ROS 2 are typed.
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
