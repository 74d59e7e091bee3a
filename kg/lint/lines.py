"""Source lines of findings, from the files on this machine."""

from __future__ import annotations

from io import StringIO
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
        lines = self.of(place.repository, place.path)
        return lines[line - 1] if line <= len(lines) else None

    def of(self, repository: str, path: str) -> Sequence[str]:
        """Return the lines of a file of a source; none if it is not available."""
        key = repository, path
        if key not in self._cache:
            file = self.file(repository, path)
            self._cache[key] = _read(file) if file is not None else ()
        return self._cache[key]

    def file(self, repository: str, path: str) -> Path | None:
        """Return a file of a source; None if the source is not on this machine, or the path leads out of it."""
        root = self._roots.get(repository)
        if not root:
            return None
        file = Path(root) / path
        return file if file.resolve().is_relative_to(Path(root).resolve()) else None


def _read(file: Path) -> list[str]:
    try:
        with file.open("rb") as opened:
            text = opened.read(_LARGEST).decode("utf-8", "replace")
    except (OSError, ValueError):
        return []
    # Unlike `splitlines`, which also ends lines at form feeds: compilers and editors do not count these.
    return [line.removesuffix("\n") for line in StringIO(text, None)]
