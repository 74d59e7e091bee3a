"""Reading of files during a package's extraction: once, with limits, as UTF-8, and recorded.

All file access of extraction is here. A result depends only on `Reader.inputs` and the look-ups in the workspace.
"""

from __future__ import annotations

import hashlib
import os
import stat
from typing import Final

from kg.corpus.files import FilePath, PackageFolder, Place, Source
from kg.corpus.workspace import INSTALLED, Workspace, real_inside
from kg.errors import CATALOGUE
from kg.facts import Problem

DEFAULT_LIMIT_BYTES: Final = 4 << 20
"""Default size limit: larger than any hand-written file, and small enough not to stop a build."""

_BINARY_SAMPLE: Final = 8192
_DIGEST_BYTES: Final = 20
_LATIN1: Final = {0xDC00 + byte: byte for byte in range(0x80, 0x100)}


def digest(data: bytes) -> str:
    """Return the hexadecimal BLAKE2b digest of the bytes of a file."""
    return hashlib.blake2b(data, digest_size=_DIGEST_BYTES).hexdigest()


def load(workspace: Workspace, file: FilePath, limit_bytes: int) -> bytes | Problem:
    """Return the bytes of a file of the build, or the problem that prevents reading it.

    Files outside of the root of their source are never read.
    """
    source = workspace.source(file.repository)
    if source is None and file.repository != INSTALLED:
        return Problem("KG110", f"{file.repository} is not a source of this build", file.path)
    if source is None:
        path = f"/{file.path}" if workspace.is_file(file) else None
    elif workspace.entry(file) is not None:
        path = f"{workspace.root(source)}/{file.path}"
    else:  # the scan only checks listed files for leaving the root
        path = real_inside(workspace.root(source), workspace.root(source) / file.path)
    if path is None:
        return Problem("KG110", "the file is not inside of its source", file.path)
    try:
        return _read_regular(path, file, limit_bytes)
    except OSError as error:
        return Problem("KG110", f"the file cannot be read: {error.strerror}", file.path)


def _read_regular(path: str, file: FilePath, limit_bytes: int) -> bytes | Problem:
    descriptor = os.open(path, os.O_RDONLY | os.O_NONBLOCK | os.O_CLOEXEC)
    with os.fdopen(descriptor, "rb", buffering=0) as stream:
        status = os.fstat(descriptor)
        if not stat.S_ISREG(status.st_mode):
            return Problem("KG110", "not a regular file", file.path)
        if status.st_size > limit_bytes:
            message = f"the file has {status.st_size} bytes, more than the limit of {limit_bytes}"
            return Problem("KG111", message, file.path)
        return stream.readall()


def mark(loaded: bytes | Problem) -> str:
    """Return the mark of a file: the digest of its bytes, or the problem that prevents reading it."""
    return digest(loaded) if isinstance(loaded, bytes) else f"{loaded.code} {loaded.message}"


class Reader:
    """Reads files for the extraction of one package, and records `problems` and `inputs`."""

    def __init__(
        self,
        workspace: Workspace,
        source: Source,
        package: PackageFolder,
        limit_bytes: int = DEFAULT_LIMIT_BYTES,
    ) -> None:
        self.workspace = workspace
        self.repository = source.repository.name
        self.package = package
        self.place = Place(self.repository, package.path, package.name)
        self.limit_bytes = limit_bytes
        self._texts: dict[FilePath, bytes | None] = {}
        self._marks: dict[FilePath, str] = {}
        self._problems: dict[Problem, None] = {}

    def for_package(self, place: Place) -> Reader:
        """Return a reader for another package, with the same record of files, whose problems are not those of this."""
        other = Reader(self.workspace, *self.workspace.folder(place), self.limit_bytes)
        other._texts, other._marks = self._texts, self._marks
        return other

    @property
    def problems(self) -> tuple[Problem, ...]:
        """Reading problems without duplicates, in the order found."""
        return tuple(self._problems)

    def sorted_problems(self) -> tuple[Problem, ...]:
        """Return the problems by path, line and code."""
        return tuple(sorted(self._problems, key=lambda problem: (problem.path, problem.line or 0, problem.code)))

    @property
    def inputs(self) -> tuple[tuple[str, str], ...]:
        """Sorted pairs of `repository:path` and `mark` of every requested file."""
        return tuple(sorted((f"{file.repository}:{file.path}", value) for file, value in self._marks.items()))

    def file(self, path: str) -> FilePath:
        """Return the key of a path of this source."""
        return FilePath(self.repository, path)

    def read(self, file: FilePath | str) -> bytes | None:
        """Return the text of a file as UTF-8, without a byte order mark; a string is a path of this source.

        None, and a problem, for a file that is unreadable, above the limit or binary; invalid UTF-8 is read as Latin-1,
        with a problem. Problems of files of other sources are reported with the packages that own them.
        """
        key = self.file(file) if isinstance(file, str) else file
        if key not in self._texts:
            loaded = load(self.workspace, key, self.limit_bytes)
            self._marks[key] = mark(loaded)
            if isinstance(loaded, Problem):
                self._report(key, loaded.code, loaded.message)
            self._texts[key] = self._normalise(key, loaded) if isinstance(loaded, bytes) else None
        return self._texts[key]

    def cached_text(self, file: FilePath) -> bytes | None:
        """Return the text of a file that `read` has read; None for others."""
        return self._texts.get(file)

    def problem(self, code: str, message: str, path: str, line: int | None = None) -> None:
        """Record a problem in the file at `path`; `code` is in the catalogue."""
        if code not in CATALOGUE:
            raise LookupError(code)
        self._problems.setdefault(Problem(code, message, path, line))

    def _report(self, file: FilePath, code: str, message: str, line: int | None = None) -> None:
        others = {source.repository.name for source in self.workspace.sources} - {self.repository}
        if file.repository not in others:
            self.problem(code, message, file.path, line)

    def _normalise(self, file: FilePath, data: bytes) -> bytes | None:
        if data.startswith((b"\xff\xfe", b"\xfe\xff")):
            self._report(file, "KG113", "the file is UTF-16")
            return data.decode("utf-16", "replace").encode()
        if b"\0" in data[:_BINARY_SAMPLE]:
            self._report(file, "KG112", "the file holds binary data")
            return None
        data = data.removeprefix(b"\xef\xbb\xbf")
        if data.isascii():
            return data
        try:
            data.decode()
        except UnicodeDecodeError as error:
            line = data.count(b"\n", 0, error.start) + 1
            self._report(file, "KG113", "the file is not UTF-8; bytes that are not were read as Latin-1", line)
            return data.decode("utf-8", "surrogateescape").translate(_LATIN1).encode()
        return data
