"""Parsing: the syntax tree of a launch file, once per process and text.

The tree is that of Python's own parser, so that a file is malformed here exactly where `ros2 launch` refuses it.
Parsing runs nothing; how deeply a text may be nested is bounded by the parser itself, and its errors are answers.
"""

from __future__ import annotations

import ast
import warnings
from dataclasses import dataclass
from functools import lru_cache

__all__ = ["Broken", "parse"]

_MAX_BYTES = 2_000_000
_REMEMBERED = 256


@dataclass(frozen=True, slots=True)
class Broken:
    """A text that is no Python, the line and what is wrong there."""

    line: int
    message: str


@lru_cache(maxsize=_REMEMBERED)
def parse(text: bytes) -> ast.Module | Broken:
    """Return the tree of a Python file, or where it is broken. Trees are shared: nobody changes them."""
    if len(text) > _MAX_BYTES:
        return Broken(1, "the file is too large to be read")
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            return ast.parse(text)
    except SyntaxError as error:
        return Broken(max(error.lineno or 1, 1), f"it is no valid Python: {error.msg}")
    except ValueError as error:  # null bytes, texts that cannot be decoded, numbers beyond the limit
        return Broken(1, f"it is no valid Python: {error}")
    except (RecursionError, MemoryError):
        return Broken(1, "it is nested too deeply to be read")
