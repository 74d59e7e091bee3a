"""Textual uses of names: lines of files that no fact covers. None of them is certain."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator
from typing import Final

from kg.facts import FileKind, Location
from kg.impact.model import Area, Effect, FileRecord, Grade, World

HOLDING: Final = frozenset({FileKind.CONFIG, FileKind.LAUNCH})
"""Kinds of files whose values name things of a system."""
_AREAS: Final = {
    FileKind.CONFIG: Area.TEXT,
    FileKind.LAUNCH: Area.LAUNCH,
    FileKind.CPP: Area.CODE,
    FileKind.PYTHON: Area.CODE,
    FileKind.BUILD: Area.PACKAGES,
    FileKind.PLUGIN: Area.PACKAGES,
}
_COMMENTS: Final = {"py": "#", "yaml": "#", "yml": "#", "txt": "#", "cmake": "#", "rq": "#"}
_LONGEST: Final = 60


def absolute_name(name: str) -> re.Pattern[str]:
    """Return the pattern of a whole absolute name that is no part of a longer name or of the path of a file."""
    return re.compile(rf"(?<![\w/.)}}~-]){re.escape(name)}(?![\w/.{{$-])")


def quoted(line: str) -> str:
    """Return a line of a file as an effect shows it."""
    text = " ".join(line.split())
    return f"`{text if len(text) <= _LONGEST else f'{text[: _LONGEST - 3]}...'}`"


def code_of(line: str, path: str) -> str:
    """Return a line without the comment at its end."""
    sign = _COMMENTS.get(path.rpartition(".")[2])
    if sign is not None:
        at = line.find(sign)
        is_open = at > 0 and (line.count("'", 0, at) % 2 or line.count('"', 0, at) % 2)
        return line if at < 0 or is_open else line[:at]
    if line.lstrip().startswith(("*", "/*", "<!--")):
        return ""
    if "<!--" in line:
        return line.partition("<!--")[0]
    return re.split(r"(?<!:)//", line, maxsplit=1)[0] if "//" in line else line


def mentions(
    world: World, files: Iterable[FileRecord], words: Iterable[str], pattern: re.Pattern[str], reason: str
) -> Iterator[Effect]:
    """Yield the lines of `files` that `pattern` matches outside of comments.

    Each match contains one of the `words`. Few lines do, and only these are examined.
    """
    for file in files:
        area = Area.PARAMETERS if file.path.endswith((".yaml", ".yml")) else _AREAS.get(file.kind, Area.TEXT)
        lines = world.lines(file.repository, file.path)
        for at in sorted({at for word in words for at, line in enumerate(lines) if word in line}):
            if pattern.search(code_of(lines[at], file.path)):
                location = Location(file.path, at + 1)
                yield Effect(Grade.MAY, area, quoted(lines[at]), reason, location, file.repository)
