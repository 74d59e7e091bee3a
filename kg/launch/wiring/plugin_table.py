"""The table of the plugins and inner nodes of nodes, `ontology/plugins.toml`, whose head explains it."""

from __future__ import annotations

import tomllib
from functools import cache
from pathlib import Path
from typing import Final, TypeVar

from kg.errors import Place as ErrorPlace
from kg.errors import UsageError
from kg.resources import folder

_Row = TypeVar("_Row")
_FILE: Final = "plugins.toml"


@cache
def rows(key: str, kind: type[_Row]) -> tuple[_Row, ...]:
    """Return the rows of one name in the table of the installation."""
    return load_rows(folder("ontology") / _FILE, key, kind)


def load_rows(path: Path, key: str, kind: type[_Row]) -> tuple[_Row, ...]:
    """Return rows of a table file; a `UsageError` KG002 names the problems of one that cannot be used."""
    try:
        return tuple(
            kind(**{key: tuple(value) if isinstance(value, list) else value for key, value in row.items()})
            for row in tomllib.loads(path.read_text("utf-8"))[key]
        )
    except (OSError, KeyError, TypeError, ValueError) as error:
        message = f"the table of plugins cannot be used: {error}"
        raise UsageError("KG002", message, place=ErrorPlace(str(path))) from error
