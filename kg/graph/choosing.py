"""Which launch configuration a person means: by the path of its file, or by package and file."""

from __future__ import annotations

import os
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Iterable

    from kg.graph.systems_reading import SystemName

__all__ = ["meant"]


def meant(text: str, names: Iterable[SystemName], roots: Iterable[tuple[str, str]], folder: Path) -> list[SystemName]:
    """Return the configurations that `text` may mean, best kind of match first, all of that kind.

    A path relative to `folder`, one relative to its source, a name (`package/launch/x.launch`), or a package and a
    file (`package x.launch`, `package/x.launch`, `package::x.launch`). `roots` are pairs of source and its folder.
    """
    known, places = list(names), dict(roots)
    path = os.path.normpath(folder / text)
    here = [one for one in known if one.repository in places and _file(places[one.repository], one.path) == path]
    if here:
        return here
    plain = text.removeprefix("./")
    named = [one for one in known if plain in {one.path, one.name}]
    if named:
        return named
    package, file = _split(plain)
    return [
        one
        for one in known
        if package and one.name.partition("/")[0] == package and f"/{one.path}".endswith(f"/{file}")
    ]


def _file(root: str, path: str) -> str:
    return os.path.normpath(Path(root) / path)


def _split(text: str) -> tuple[str, str]:
    for sign in (" ", "::", "/"):
        package, found, file = text.partition(sign)
        if found:
            return package.strip(), file.strip()
    return "", text
