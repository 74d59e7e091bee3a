"""What is wrong with a program, and where: at a block, which has a line and column if the program is a text."""

from __future__ import annotations

from typing import TYPE_CHECKING, Literal

import msgspec

from kg.errors import Place

if TYPE_CHECKING:
    from collections.abc import Mapping

    from kg.errors import RobotError

__all__ = ["Problem", "place_at"]


class Problem(msgspec.Struct, frozen=True, kw_only=True, omit_defaults=True):
    """Something wrong with a program.

    `path` leads to the part of the tree (`/body/0/then/1/condition`), `id` is that of the statement it belongs to. A
    program with an `error` is not run; with a `warning` it is.
    """

    id: str | None
    path: str
    message: str
    hint: str | None = None
    code: str = "KG836"
    severity: Literal["error", "warning"] = "error"

    @classmethod
    def of(cls, error: RobotError, path: str, identifier: str | None) -> Problem:
        """Return the problem that an error is."""
        return cls(id=identifier, path=path, message=error.message, hint=error.hint, code=error.code)


def place_at(file: str, text: str | None, places: Mapping[str, tuple[int, int]], path: str) -> Place:
    """Return the place of a part of a program's tree: its line in the text, or of the nearest part above it.

    A program that is not text (`text` is None) has the path in place of a line.
    """
    if text is None:
        return Place(f"{file}#{path}")
    above = path
    while above and above not in places:
        above = above.rpartition("/")[0]
    line, column = places.get(above, (1, 1))
    lines = text.split("\n")
    return Place(file, line, column, lines[line - 1] if line <= len(lines) else "")
