"""Which of the rules read are checked: those named, else people's own, else those that `kg` ships."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from kg.rules.files import NOTATIONS

if TYPE_CHECKING:
    from collections.abc import Iterable

    from kg.rules.checks.run import Read

__all__ = ["named", "others_than", "outside"]


def named(found: Read, word: str) -> list[str]:
    """Return the rules that a word means: one by its name, a family, a file or a folder; files with errors too."""
    path = Path(word).resolve()
    family = f"{word.rstrip('/')}/"
    return [
        name
        for name, file in found.paths
        if name == word or name.startswith(family) or file.resolve().is_relative_to(path)
    ]


def outside(found: Read, words: Iterable[str]) -> list[Path]:
    """Return the files among `words` that have the ending of a rule and were not read."""
    read = {file.resolve() for _, file in found.paths}
    files = (Path(word) for word in words)
    return [file for file in files if file.suffix in NOTATIONS and file.is_file() and file.resolve() not in read]


def others_than(found: Read, shipped: Path) -> list[str]:
    """Return the rules outside the folder `shipped`."""
    folder = shipped.resolve()
    return [name for name, file in found.paths if not file.resolve().is_relative_to(folder)]
