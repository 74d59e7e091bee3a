"""The files that descriptions include or load, found by what is written; nothing outside of the build is read."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Final

from kg.extract.launch.expressions import NotKnownError
from kg.extract.launch.files import SCHEME, Found
from kg.extract.launch.ros1.parameterfile import read_tree
from kg.extract.launch.ros1.texts import HOLE, shown
from kg.extract.launch.ros1.values import automatic

if TYPE_CHECKING:
    from kg.corpus.files import FilePath
    from kg.extract.launch.files import Files

__all__ = ["Loading"]

_MOST_TEXT: Final = 1 << 20


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
        return self._files.find(text)

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
