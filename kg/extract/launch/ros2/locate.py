"""Files that launch files name, found where the sources have them."""

from __future__ import annotations

from typing import TYPE_CHECKING

from kg.corpus.files import FilePath
from kg.extract.launch.files import SCHEME
from kg.extract.launch.ros2.context import HOLE
from kg.facts import LaunchProblemKind

if TYPE_CHECKING:
    from kg.extract.launch.files import Files
    from kg.extract.launch.ros2.context import Context

__all__ = ["find", "read", "unreadable"]


def read(context: Context, text: str) -> tuple[FilePath, bytes] | None:
    """Return the file that a text names, and its content; None, and a problem, where it cannot be read."""
    made = context.found.generated.get(text)
    if made is not None:
        return made.file, made.content
    file = find(context, text)
    if file is None:
        return None
    content = context.files.read(file)
    if content is None:
        unreadable(context, file)
        return None
    context.found.files.setdefault(file)
    return file, content


def unreadable(context: Context, file: FilePath) -> None:
    """Note that a file is there and cannot be read."""
    context.problem(LaunchProblemKind.LIMIT, f"`{file.path}` is too large, or no text", file.path)


def find(context: Context, text: str) -> FilePath | None:
    """Return the file that a text names; None, and a problem, where there is none or it cannot be known.

    Where a package installs its files in other folders than its source has, the one file of the package counts whose
    path ends as the one that is named.
    """
    if HOLE in text:
        return None
    file = context.files.at(text)
    if file is None:
        if not text.startswith(SCHEME):
            context.problem(LaunchProblemKind.UNRESOLVED, f"`{text}` is no file of a package", text)
        return None
    found = file if context.files.exists(file) else _installed_elsewhere(context.files, text)
    if found is None:
        context.problem(LaunchProblemKind.MISSING_FILE, f"there is no file `{text}`", text)
    return found


def _installed_elsewhere(files: Files, text: str) -> FilePath | None:
    package, _, rest = text.removeprefix(SCHEME).partition("/")
    known = files.reader.workspace.package(package, files.reader.repository)
    if known is None or not text.startswith(SCHEME):
        return None
    parts = [part for part in rest.split("/") if part not in ("", ".", "..")]
    paths = [entry.path for entry in files.reader.workspace.folder(known)[1].files]
    for length in range(len(parts), 0, -1):
        tail = "/" + "/".join(parts[-length:])
        ending = [path for path in paths if f"/{path}".endswith(tail)]
        if ending:
            return FilePath(known.repository, ending[0]) if len(ending) == 1 else None
    return None
