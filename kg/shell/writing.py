"""Results as text: for the clipboard, and complete in a file."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from kg.errors import Place, UsageError
from kg.query.formats import BOOLEAN_FORMATS, GRAPH_FORMATS, SOLUTION_FORMATS, write
from kg.query.result import Boolean, Graph, Result, Solutions
from kg.query.writing import parquet

_ENDINGS = {
    "tsv": ".tsv",
    "csv": ".csv",
    "json": ".json",
    "xml": ".xml",
    "markdown": ".md",
    "jsonl": ".jsonl",
    "turtle": ".ttl",
    "ntriples": ".nt",
    "nquads": ".nq",
    "trig": ".trig",
    "jsonld": ".jsonld",
    "rdfxml": ".rdf",
    parquet.NAME: ".parquet",
}


def formats_of(result: Result) -> list[str]:
    """Return the formats for this kind of result, the most used first."""
    names = list(GRAPH_FORMATS if isinstance(result, Graph) else SOLUTION_FORMATS)
    if isinstance(result, Boolean):
        names = list(BOOLEAN_FORMATS)
    first = [name for name in ("tsv", "csv", "json", "markdown", "turtle") if name in names]
    return [*first, *(name for name in names if name not in first)]


def file_formats_of(result: Result) -> list[str]:
    """Return the formats of files: those of `formats_of`, and Parquet if it is supported."""
    return [*formats_of(result), *([parquet.NAME] if isinstance(result, Solutions) and parquet.is_installed() else [])]


def format_of_name(path: str, result: Result) -> str | None:
    """Return the format of a file name's suffix, None for an unknown one."""
    return next((name for name in file_formats_of(result) if path.lower().endswith(_ENDINGS[name])), None)


def copied(result: Result, name: str) -> str:
    """Return a result in the format `name`."""
    return write(result, name).decode("utf-8", errors="replace")


def is_taken(path: str) -> bool:
    """Return whether a file exists; UsageError KG553 if that cannot be determined."""
    with _reported(path):
        return Path(path).expanduser().exists()


def to_file(result: Result, path: str, name: str) -> int:
    """Write a result to a file and return the number of bytes; UsageError KG553 on failure."""
    content = write(result, name)
    with _reported(path):
        return Path(path).expanduser().write_bytes(content)


@contextmanager
def _reported(path: str) -> Iterator[None]:
    """Report path errors as KG553; the home of an unknown user is a RuntimeError."""
    try:
        yield
    except (OSError, RuntimeError, ValueError) as error:
        message = f"the file cannot be written: {getattr(error, 'strerror', None) or error}"
        raise UsageError("KG553", message, place=Place(path), hint="Name another file.") from error
