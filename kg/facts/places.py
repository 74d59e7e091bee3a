"""Places of facts."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class Location:
    """A line of a file, relative to the root of its source; line 0 is the file as a whole.

    For facts observed at run time, `path` is the peer that showed it: its name and its address. `repository` is None
    for the source of the fact itself, else the name of another source of the build, which contains the file (a base
    class, for example).
    """

    path: str
    line: int
    repository: str | None = None

    def __str__(self) -> str:
        return f"{self.path}:{self.line}" if self.line else self.path
