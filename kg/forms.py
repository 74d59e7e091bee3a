"""Forms of values in settings: each function parses a text or a TOML value.

The second argument is the base folder of relative paths. The text of `FormError` describes the form, and completes
"X, which is not ...".
"""

from __future__ import annotations

import math
import os
import re
from collections.abc import Callable
from pathlib import Path
from typing import Any, Final, TypeAlias

__all__ = [
    "Form",
    "FormError",
    "address",
    "cluster",
    "codes",
    "file",
    "folder_or_address",
    "iri",
    "number",
    "one_of",
    "path",
    "paths",
    "pipeline",
    "root_path",
    "size",
    "size_or_none",
    "store",
    "switch",
    "text",
    "whole",
    "word",
    "words",
]


class FormError(ValueError):
    """Malformed value; the text describes the required form."""


Form: TypeAlias = "Callable[[object, Path], Any]"
_ROOT_PATH: Final = re.compile(r"(?:/[A-Za-z0-9_-][A-Za-z0-9._-]*)*")
_UNITS: Final = {"k": 10, "m": 20, "g": 30}


def number(least: float) -> Form:
    """Return the form of finite numbers of at least `least`."""
    return lambda value, _base: _number(value, least)


def whole(least: int, most: int | None = None) -> Form:
    """Return the form of whole numbers from `least` to `most`."""
    bounds = f"a whole number of at least {least}" if most is None else f"a whole number from {least} to {most}"

    def read(value: object, _base: Path) -> int:
        parsed = _number(value, float("-inf"), bounds)
        if parsed != int(parsed) or parsed < least or (most is not None and parsed > most):
            raise FormError(bounds)
        return int(parsed)

    return read


def size(value: object, _base: Path) -> int:
    """Parse a number of bytes: `800`, `500K`, `4M` or `1G`."""
    text = str(value).strip()
    unit = _UNITS.get(text[-1:].lower(), 0)
    parsed = _number(text[:-1] if unit else text, float("-inf"), "a size: bytes, or 500K, 4M, 1G")
    if parsed * (1 << unit) < 1:
        raise FormError("a size of at least 1 byte")
    return int(parsed * (1 << unit))


def size_or_none(value: object, base: Path) -> int:
    """Parse a number of bytes; 0 means no limit."""
    return 0 if str(value).strip() == "0" else size(value, base)


def switch(value: object, _base: Path) -> bool:
    """Parse a boolean from a flag, a variable (`1`, `true`, `yes`, `on` and their opposites) or TOML."""
    word = str(value).strip().lower()
    if word in {"1", "true", "yes", "on"}:
        return True
    if word in {"0", "false", "no", "off"}:
        return False
    raise FormError("true or false")


def text(value: object, _base: Path) -> str:
    """Parse a text that is not empty."""
    if not isinstance(value, str) or not value.strip():
        raise FormError("a text")
    return value.strip()


def words(value: object, _base: Path) -> tuple[str, ...]:
    """Parse a list of words; a text separates them by commas or spaces."""
    items = value.replace(",", " ").split() if isinstance(value, str) else value
    if not isinstance(items, list | tuple) or not all(isinstance(one, str) and one for one in items):
        raise FormError("a list of words")
    return tuple(items)


def codes(value: object, base: Path) -> tuple[str, ...]:
    """Parse a list of codes; returns them in upper case."""
    return tuple(one.upper() for one in words(value, base))


def root_path(value: object, _base: Path) -> str:
    """Parse the root path of a web server, `/` or `/kg`; returns it without a trailing slash."""
    stripped = value.strip().rstrip("/") if isinstance(value, str) else None
    if stripped is None or not _ROOT_PATH.fullmatch(stripped):
        raise FormError("a path such as /kg, of letters, digits, `-`, `_` and `.`")
    return stripped


def word(value: object, _base: Path) -> str:
    """Parse a word; returns it in lower case."""
    if not isinstance(value, str) or not value.strip():
        raise FormError("a word")
    return value.strip().lower()


def one_of(*choices: str) -> Form:
    """Return the form of a choice from `choices`."""

    def read(value: object, _base: Path) -> str:
        chosen = str(value).lower()
        if chosen not in choices:
            raise FormError("one of " + ", ".join(choices))
        return chosen

    return read


def path(value: object, base: Path) -> Path:
    """Parse a path."""
    if not isinstance(value, str | Path) or not str(value).strip():
        raise FormError("a path")
    try:
        return base / Path(value).expanduser()
    except (RuntimeError, ValueError):  # the home of an unknown user, an invalid character
        raise FormError("a path") from None


def paths(value: object, base: Path) -> tuple[Path, ...]:
    """Parse a list of paths; a text separates them as in `PATH`."""
    parts = [part for part in value.split(os.pathsep) if part] if isinstance(value, str) else value
    if not isinstance(parts, list | tuple):
        raise FormError("a list of paths")
    return tuple(path(part, base) for part in parts)


def file(value: object, base: Path) -> str:
    """Parse an optional path."""
    return str(path(value, base)) if value else ""


def pipeline(value: object, base: Path) -> str:
    """Parse the name or path of a spaCy pipeline."""
    if not isinstance(value, str):
        raise FormError("the name or path of a spaCy pipeline")
    return str(path(value, base)) if "/" in value or value.startswith((".", "~")) else value.strip()


def iri(value: object, _base: Path) -> str:
    """Parse the base of IRIs; returns it with a trailing slash."""
    given = str(value)
    host = given.partition("://")[2].partition("/")[0]
    if not given.startswith(("http://", "https://")) or not host or any(sign in given for sign in ' <>"{}|\\^`#?'):
        raise FormError("an IRI that starts with http:// or https:// and has no # or ?")
    return given if given.endswith("/") else given + "/"


def address(value: object, _base: Path) -> str:
    """Parse the address of a robot."""
    spaced = isinstance(value, str) and not value.startswith("bag:") and any(sign.isspace() for sign in value.strip())
    if not isinstance(value, str) or spaced:
        raise FormError("the address of a robot")
    return value.strip()


def cluster(value: object, _base: Path) -> str:
    """Parse the optional address of a Dask cluster."""
    given = value.strip() if isinstance(value, str) else ""
    kind, mark, workers = given.partition(":")
    local = kind == "local" and (not mark or workers.isdecimal())
    if value != "" and not local and not re.fullmatch(r"(tcp|tls|ws|wss)://[^\s/]+:\d+", given):
        raise FormError("tcp://HOST:PORT of a scheduler, local, or local:N")
    return given


def store(value: object, base: Path) -> Path | str:
    """Parse a path, or the address of a SPARQL server."""
    if isinstance(value, str) and value.startswith(("http://", "https://")):
        return value
    return path(value, base)


def folder_or_address(value: object, base: Path) -> str:
    """Parse an optional path, or an address with a scheme."""
    return value if isinstance(value, str) and "://" in value else file(value, base)


def _number(value: object, least: float, form: str = "") -> float:
    form = form or f"a number of at least {least:g}"
    try:
        parsed = float(str(value).replace("_", ""))
    except ValueError:
        raise FormError(form) from None
    if isinstance(value, bool) or not math.isfinite(parsed) or parsed < least:
        raise FormError(form)
    return parsed
