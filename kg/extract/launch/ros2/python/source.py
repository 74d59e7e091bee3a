"""Parsing: a launch file once per process and text.

Python's own parser tells whether a file is malformed, exactly as `ros2 launch` does; it runs nothing. How deeply a text
may be nested is bounded by the parser itself, and its errors are answers.
"""

from __future__ import annotations

import ast
import warnings
from dataclasses import dataclass
from functools import lru_cache
from typing import TYPE_CHECKING

from kg.extract.python.units import PythonUnit

if TYPE_CHECKING:
    from kg.corpus.files import FilePath

__all__ = ["Broken", "parse"]

_MAX_BYTES = 2_000_000
_REMEMBERED = 256


@dataclass(frozen=True, slots=True)
class Broken:
    """A text that is no Python, the line and what is wrong there."""

    line: int
    message: str


@lru_cache(maxsize=_REMEMBERED)
def parse(file: FilePath, text: bytes) -> PythonUnit | Broken:
    """Return the form of a Python file, or where it is broken."""
    if len(text) > _MAX_BYTES:
        return Broken(1, "the file is too large to be read")
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            ast.parse(text)
    except SyntaxError as error:
        return Broken(max(error.lineno or 1, 1), f"it is no valid Python: {error.msg}")
    except ValueError as error:  # null bytes, texts that cannot be decoded, numbers beyond the limit
        return Broken(1, f"it is no valid Python: {error}")
    except (RecursionError, MemoryError):
        return Broken(1, "it is nested too deeply to be read")
    return PythonUnit(file, text, {})
