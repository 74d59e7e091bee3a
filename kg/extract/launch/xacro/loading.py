"""The files that descriptions include or load, found by what is written; nothing outside of the build is read."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Final

from kg.extract.launch.expressions.dialect import NotKnownError
from kg.extract.launch.files import SCHEME
from kg.extract.launch.ros1.parameterfile import read_tree
from kg.extract.launch.ros1.texts import HOLE, shown
from kg.extract.launch.ros1.values import automatic
from kg.facts import LaunchProblemKind

if TYPE_CHECKING:
    from kg.corpus.files import FilePath
    from kg.extract.launch.files import Files

__all__ = ["Found", "Loading"]

_MOST_NAME: Final = 200
"""Characters of the name of a file or folder, which file systems bound to 255 bytes."""
_MOST_TEXT: Final = 1 << 20


@dataclass(frozen=True, slots=True)
class Found:
    """The file that a text names, or what kind of problem it is that there is none, and why."""

    file: FilePath | None
    kind: LaunchProblemKind = LaunchProblemKind.UNRESOLVED
    reason: str | None = None
    subject: str | None = None


class Loading:
    """Finds and reads files; `read` are those that were read, in their order."""

    def __init__(self, files: Files) -> None:
        self.read: dict[FilePath, None] = {}
        self._files = files

    def data(self, file: FilePath) -> bytes | None:
        """Return the text of a file as UTF-8; None when there is none, or it is too large or binary."""
        data = self._files.read(file)
        if data is not None:
            self.read[file] = None
        return data

    def find(self, written: str, folder: str) -> Found:
        """Return the file that a text names from a folder."""
        text = written if written.startswith(("/", SCHEME)) or "://" in written else f"{folder}/{written}"
        if HOLE in text or any(mark in text for mark in "*?["):
            return Found(None, reason=f"which file {shown(text)} is, is not known", subject=text)
        if any(len(part) > _MOST_NAME for part in text.split("/")):
            return Found(None, reason="the name of the file is too long")
        file = self._files.at(text)
        if file is not None and self._files.exists(file):
            return Found(file)
        if file is not None:
            return Found(None, LaunchProblemKind.MISSING_FILE, f"there is no file {text}", text)
        package = text.removeprefix(SCHEME).partition("/")[0]
        if text.startswith(SCHEME) and self._files.share(package) is None:
            reason = f"the package '{package}' is neither in the build nor installed"
            return Found(None, LaunchProblemKind.UNKNOWN_PACKAGE, reason, package)
        return Found(None, reason=f"the file {text} stands outside of the build", subject=text)

    def yaml(self, written: str, folder: str) -> object:
        """Return a file of YAML as dictionaries; `NotKnownError` where there is none that can be read."""
        file = self.find(written, folder).file
        data = self.data(file) if file is not None else None
        if data is None or len(data) > _MOST_TEXT:
            raise NotKnownError
        tree = read_tree(data.decode())
        if not tree.is_mapping or tree.problems:
            raise NotKnownError
        whole: dict[str, Any] = {}
        for leaf in tree.leaves:
            inner = whole
            for key in leaf.keys[:-1]:
                inner = inner.setdefault(key, {})
            value = leaf.value
            inner[leaf.keys[-1]] = HOLE if value is None else automatic(value.strip("'\"") if leaf.type else value)
        return whole
