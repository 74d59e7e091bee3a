"""Programs in files: text (`.kgp`), or JSON (`.json`)."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Final, NamedTuple

from kg.errors import Place, RobotError, UsageError
from kg.robot.programs.form import decode
from kg.robot.programs.parse import parse_with_places
from kg.robot.programs.problems import place_at
from kg.robot.programs.tree import Program  # noqa: TC001 - read when the class is made
from kg.robot.programs.trees import program_of

if TYPE_CHECKING:
    from collections.abc import Mapping

    from kg.robot.capability import Capabilities

__all__ = ["SUFFIX", "Loaded", "load", "load_tree"]

SUFFIX: Final = ".kgp"
"""How the name of a program in text ends."""
_MOST: Final = 4 << 20


class Loaded(NamedTuple):
    """A program with where it came from; `text` is None for JSON."""

    program: Program
    path: str
    text: str | None
    places: Mapping[str, tuple[int, int]]

    def place(self, path: str) -> Place:
        """Return the place in the file of a part of the tree."""
        return place_at(self.path, self.text, self.places, path)


def load(path: str) -> Loaded:
    """Read a program.

    Raises:
        UsageError: KG003 for a file that cannot be read.
        RobotError: KG830, KG831 for one that is not a program.
    """
    data = _content(path)
    if path.endswith(".xml"):
        hint = f"Convert it: `kg robot convert {path} > {Path(path).stem}{SUFFIX}`."
        raise RobotError("KG830", "a behaviour tree is not a program", place=Place(path), hint=hint)
    if path.endswith(".json"):
        return Loaded(decode(data, path), path, None, {})
    try:
        text = data.decode()
    except UnicodeDecodeError:
        raise RobotError("KG830", "the text is not in UTF-8", place=Place(path)) from None
    program, places = parse_with_places(text, path)
    return Loaded(program, path, text.replace("\r\n", "\n"), places)


def load_tree(path: str, capabilities: Capabilities) -> Loaded:
    """Read a behaviour tree as a program.

    Raises:
        UsageError: KG003 for a file that cannot be read.
        RobotError: KG830 for one that is too large, KG842 for one that no program stands for.
    """
    return Loaded(program_of(_content(path), capabilities, path), path, None, {})


def _content(path: str) -> bytes:
    try:
        with Path(path).open("rb") as file:
            data = file.read(_MOST + 1)
    except OSError as error:
        raise UsageError("KG003", f"`{path}` cannot be read: {error.strerror}") from error
    if len(data) > _MOST:
        raise RobotError("KG830", "a program is not larger than 4 MB", place=Place(path))
    return data
