"""Licences as package.xml names them, and the SPDX licence that each name stands for (`ontology/licenses.toml`)."""

from __future__ import annotations

import tomllib
from functools import cache

from kg.resources import folder

__all__ = ["spdx"]


@cache
def _table() -> dict[str, str]:
    listed = tomllib.loads((folder("ontology") / "licenses.toml").read_text("utf-8"))
    known = {
        key(name): f"{listed['base']}{identifier}" for identifier, names in listed["names"].items() for name in names
    }
    return known | {key(identifier): f"{listed['base']}{identifier}" for identifier in listed["names"]}


def key(name: str) -> str:
    """Return `name` without what spellings of the same licence differ in: case, punctuation and spaces."""
    return "".join(character for character in name.casefold() if character.isalnum() or character == "+")


def spdx(name: str) -> str | None:
    """Return the IRI of the SPDX licence that `name` stands for, None when it does not say which (`BSD`)."""
    return _table().get(key(name))
