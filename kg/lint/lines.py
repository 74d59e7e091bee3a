"""Source lines of findings, from the files on this machine."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Final

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from kg.lint.finding import Evidence

_LARGEST: Final = 4 << 20


class Lines:
    """Reads each file once; `roots` are the folders of the sources by name. Files outside of them are never read."""

    def __init__(self, roots: Mapping[str, str]) -> None:
        self._roots = roots
        self._cache: dict[tuple[str, str], Sequence[str]] = {}

    def at(self, place: Evidence, line: int | None) -> str | None:
        """Return the line of a place, counted from one; None if it is not available."""
        if line is None or line < 1:
            return None
        key = (place.repository, place.path)
        if key not in self._cache:
            file = self.file(place)
            self._cache[key] = _read(file) if file is not None else ()
        lines = self._cache[key]
        return lines[line - 1] if line <= len(lines) else None

    def file(self, place: Evidence) -> Path | None:
        """Return the file of a place; None if its source is not on this machine, or the path leads out of it."""
        root = self._roots.get(place.repository)
        if not root:
            return None
        file = Path(root) / place.path
        return file if file.resolve().is_relative_to(Path(root).resolve()) else None


def _read(file: Path) -> list[str]:
    try:
        with file.open("rb") as opened:
            return opened.read(_LARGEST).decode("utf-8", "replace").splitlines()
    except (OSError, ValueError):
        return []
