"""RDF files: their format, their content for the engine, and errors at their place."""

from __future__ import annotations

import re
import zlib
from contextlib import AbstractContextManager, contextmanager
from typing import IO, TYPE_CHECKING, Final, TypeAlias, cast

from pyoxigraph import Quad, RdfFormat, parse

from kg.errors import GraphError, Place, SourceError
from kg.lazily import lazily

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator
    from pathlib import Path

    Reopened: TypeAlias = Callable[[], AbstractContextManager[IO[bytes]]]

with lazily():
    import gzip
    from xml.parsers import expat

BYTE_ORDER_MARK: Final = b"\xef\xbb\xbf"
_PLACE: Final = re.compile(r"Parser error (?:at|between) line [^:]*: ")
_CHUNK: Final = 1 << 20
_ANY_BASE: Final = "https://example.org/"


def format_of(path: Path) -> RdfFormat | None:
    """Return the format that the ending of a file names, also before `.gz`; None if it names none."""
    ending = path.name.lower().removesuffix(".gz").rpartition(".")[2]
    return RdfFormat.from_extension("rdf" if ending == "owl" else ending)


def required_format_of(path: Path) -> RdfFormat:
    """Return the format that the ending of a file names; GraphError KG601 if it names none."""
    form = format_of(path)
    if form is None:
        hint = "Name the format with `--format`."
        raise GraphError("KG601", f"the format of `{path.name}` is not known", place=Place(str(path)), hint=hint)
    return form


@contextmanager
def opened(path: Path) -> Iterator[IO[bytes]]:
    """Open a file for the engine: unpacked if it ends in `.gz`, and without a byte order mark.

    Raises:
        SourceError: KG101 if the file cannot be opened.
        GraphError: KG601, also while it is read, if it cannot be unpacked.
    """
    try:
        plain = path.open("rb")
    except OSError as error:
        raise SourceError("KG101", f"cannot be opened: {error.strerror}", place=Place(str(path))) from error
    with plain:
        file = cast("IO[bytes]", _Unpacked(plain, path) if path.suffix.lower() == ".gz" else plain)
        start = file.read(len(BYTE_ORDER_MARK))
        yield cast("IO[bytes]", _Continued(b"" if start == BYTE_ORDER_MARK else start, file))


class _Continued:
    """A file whose first bytes were read before; through a method in Python, Ctrl-C ends a load at the next read."""

    def __init__(self, start: bytes, file: IO[bytes]) -> None:
        self._start = start
        self._file = file

    def read(self, size: int = -1) -> bytes:
        """Return the next bytes, at most `size`."""
        start, self._start = self._start, b""
        return start + self._file.read(size if size < 0 else max(size - len(start), 0))


class _Unpacked:
    """A compressed file that reports damage as KG601."""

    def __init__(self, file: IO[bytes], path: Path) -> None:
        self._file = gzip.GzipFile(fileobj=file)
        self._path = path

    def read(self, size: int = -1) -> bytes:
        """Return the next bytes, at most `size`."""
        try:
            return self._file.read(size)
        except (EOFError, OSError, zlib.error) as error:  # one of them is BadGzipFile
            raise GraphError("KG601", f"cannot be unpacked: {error}", place=Place(str(self._path))) from error


@contextmanager
def parsing(rdf_format: RdfFormat, reopened: Reopened) -> Iterator[None]:
    """Raise syntax errors of the engine with a line, and an error for RDF/XML that is cut off.

    The engine reports no lines of RDF/XML, and takes its end for the end of all open elements. `reopened` opens the
    content once more. Raises SyntaxError with `msg`, `lineno`, and `offset` if known.
    """
    try:
        yield
    except SyntaxError as error:
        error.msg = _PLACE.sub("", error.msg or "it does not parse")
        if error.lineno is None:
            error.lineno = _line(rdf_format, reopened)
        raise
    if rdf_format == RdfFormat.RDF_XML and (line := _cut_off(reopened)):
        problem = SyntaxError("the XML document ends too early")
        problem.lineno = line
        raise problem


@contextmanager
def reading(path: Path, rdf_format: RdfFormat) -> Iterator[IO[bytes]]:
    """Open a file for the engine; raises as `opened`, and GraphError KG601 with the line if it does not parse."""
    try:
        with parsing(rdf_format, lambda: opened(path)), opened(path) as file:
            yield file
    except SyntaxError as error:
        raise GraphError("KG601", error.msg, place=Place(str(path), error.lineno, error.offset)) from error


def quads_of(path: Path, rdf_format: RdfFormat, *, rename: bool = False) -> Iterator[Quad]:
    """Yield the quads of a file; relative IRIs are resolved against its address. Raises as `reading`."""
    with reading(path, rdf_format) as file:
        yield from parse(file, rdf_format, base_iri=path.absolute().as_uri(), rename_blank_nodes=rename)


class _Lines:
    """A file that the engine gets line by line, so `number` is the line of its error."""

    def __init__(self, file: IO[bytes]) -> None:
        self.number = 1
        self._at_end = False
        self._buffer = b""
        self._file = file

    def read(self, size: int = -1) -> bytes:
        """Return the rest of the line, at most `size` bytes."""
        self._buffer = self._buffer or self._file.read(_CHUNK)
        end = self._buffer.find(b"\n") + 1 or len(self._buffer)
        end = end if size < 0 else min(end, size)
        part, self._buffer = self._buffer[:end], self._buffer[end:]
        self.number += self._at_end
        self._at_end = part.endswith(b"\n")
        return part


def _line(rdf_format: RdfFormat, reopened: Reopened) -> int | None:
    with reopened() as file:
        lines = _Lines(file)
        try:
            for _ in parse(cast("IO[bytes]", lines), rdf_format, base_iri=_ANY_BASE):
                pass
        except SyntaxError:
            return lines.number
    return None


def _cut_off(reopened: Reopened) -> int | None:
    """Return the last line of an XML document whose elements are not all closed, else None."""
    no_end = expat.errors.codes[expat.errors.XML_ERROR_NO_ELEMENTS]
    parser = expat.ParserCreate()
    with reopened() as file:
        try:
            while chunk := file.read(_CHUNK):
                parser.Parse(chunk, False)
            parser.Parse(b"", True)
        except expat.ExpatError as error:
            return error.lineno if error.code == no_end else None
    return None
