"""Where a fact was read."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class Location:
    """A line of a file, relative to the root of its source; line 0 is the file as a whole.

    Of what was seen running, `path` is the peer that showed it: its name and its address.
    `repository` is None for the source that the fact belongs to, else the name of the other source of the
    build that the file stands in (a base class, say).
    """

    path: str
    line: int
    repository: str | None = None

    def __str__(self) -> str:
        return f"{self.path}:{self.line}" if self.line else self.path
