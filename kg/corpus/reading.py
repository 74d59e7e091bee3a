"""How a package's extraction reads files: once, within limits, as UTF-8, and on record.

Nothing else in extraction opens files, so that `Reader.inputs` is all that the result depends on.
"""

from __future__ import annotations

import hashlib
import os
import stat
from typing import TYPE_CHECKING, Final

from kg.corpus.files import FilePath
from kg.corpus.workspace import INSTALLED, real_inside
from kg.errors import CATALOGUE
from kg.facts import Problem

if TYPE_CHECKING:
    from pathlib import Path

    from kg.corpus.files import PackageFolder, Source
    from kg.corpus.workspace import Workspace

__all__ = ["DEFAULT_LIMIT_BYTES", "Reader", "digest"]

DEFAULT_LIMIT_BYTES: Final = 4 << 20
"""Larger than any file that people wrote and smaller than what would stop a build."""

_BINARY_SAMPLE: Final = 8192
_DIGEST_BYTES: Final = 20
_LATIN1: Final = {0xDC00 + byte: byte for byte in range(0x80, 0x100)}


def digest(data: bytes) -> str:
    """Return the BLAKE2b digest of the bytes of a file, as hexadecimal."""
    return hashlib.blake2b(data, digest_size=_DIGEST_BYTES).hexdigest()


class Reader:
    """Reads files for the extraction of one package; `problems` and `inputs` tell what happened."""

    def __init__(
        self,
        workspace: Workspace,
        source: Source,
        package: PackageFolder,
        limit_bytes: int = DEFAULT_LIMIT_BYTES,
    ) -> None:
        self.workspace = workspace
        self.source = source
        self.package = package
        self.limit_bytes = limit_bytes
        self._texts: dict[FilePath, bytes | None] = {}
        self._digests: dict[FilePath, str] = {}
        self._problems: dict[Problem, None] = {}

    def beside(self, source: Source, package: PackageFolder) -> Reader:
        """Return a reader for another package of the build that keeps the same record."""
        other = Reader(self.workspace, source, package, self.limit_bytes)
        other._texts, other._digests, other._problems = self._texts, self._digests, self._problems
        return other

    @property
    def problems(self) -> tuple[Problem, ...]:
        """What could not be read as it should, in the order found, each once."""
        return tuple(self._problems)

    @property
    def inputs(self) -> tuple[tuple[str, str], ...]:
        """Pairs of `repository:path` and digest of every file read, sorted."""
        return tuple(sorted((f"{file.repository}:{file.path}", value) for file, value in self._digests.items()))

    def file(self, path: str) -> FilePath:
        """Return the key of a path of this source."""
        return FilePath(self.source.repository.name, path)

    def read(self, file: FilePath | str) -> bytes | None:
        """Return the text of a file as UTF-8, without a byte order mark; a string is a path of this source.

        None, and a problem, for a file that is unreadable, larger than the limit or binary; bytes that are not
        UTF-8 are read as Latin-1, with a problem. Files outside of the source's root are never read.
        """
        key = self.file(file) if isinstance(file, str) else file
        if key not in self._texts:
            data = self._load(key)
            self._texts[key] = None if data is None else self._normalise(key, data)
        return self._texts[key]

    def problem(self, code: str, message: str, path: str, line: int | None = None) -> None:
        """Note that something in the file at `path` could not be read as it should; `code` is in the catalogue."""
        if code not in CATALOGUE:
            raise LookupError(code)
        self._problems.setdefault(Problem(code, message, path, line))

    def _load(self, file: FilePath) -> bytes | None:
        source = self.workspace.source(file.repository)
        if source is None and file.repository != INSTALLED:
            self.problem("KG110", f"{file.repository} is no source of this build", file.path)
            return None
        path = self._inside(source.root, file) if source else self._installed(file)
        if path is None:
            self.problem("KG110", "the file is not inside of its source", file.path)
            return None
        try:
            return self._read_regular(path, file)
        except OSError as error:
            self.problem("KG110", f"the file cannot be read: {error.strerror}", file.path)
            return None

    def _inside(self, root: Path, file: FilePath) -> str | None:
        """Return where a file stands on disk; those that the scan did not list are checked for leaving the root."""
        if self.workspace.entry(file) is not None:
            return f"{root}/{file.path}"
        return real_inside(root, root / file.path)

    def _installed(self, file: FilePath) -> str | None:
        return f"/{file.path}" if self.workspace.is_file(file) else None

    def _read_regular(self, path: str, file: FilePath) -> bytes | None:
        descriptor = os.open(path, os.O_RDONLY | os.O_NONBLOCK | os.O_CLOEXEC)
        with os.fdopen(descriptor, "rb", buffering=0) as stream:
            status = os.fstat(descriptor)
            if not stat.S_ISREG(status.st_mode):
                self.problem("KG110", "it is no regular file", file.path)
                return None
            if status.st_size > self.limit_bytes:
                message = f"the file has {status.st_size} bytes, more than the limit of {self.limit_bytes}"
                self.problem("KG111", message, file.path)
                return None
            data = stream.readall()
        self._digests[file] = digest(data)
        return data

    def _normalise(self, file: FilePath, data: bytes) -> bytes | None:
        if data.startswith((b"\xff\xfe", b"\xfe\xff")):
            self.problem("KG113", "the file is UTF-16", file.path)
            return data.decode("utf-16", "replace").encode()
        if b"\0" in data[:_BINARY_SAMPLE]:
            self.problem("KG112", "the file holds binary data", file.path)
            return None
        data = data.removeprefix(b"\xef\xbb\xbf")
        if data.isascii():
            return data
        try:
            data.decode()
        except UnicodeDecodeError as error:
            line = data.count(b"\n", 0, error.start) + 1
            self.problem("KG113", "the file is not UTF-8; bytes that are not were read as Latin-1", file.path, line)
            return data.decode("utf-8", "surrogateescape").translate(_LATIN1).encode()
        return data
