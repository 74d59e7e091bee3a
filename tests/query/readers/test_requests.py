"""Tests of receiving requests and reporting errors."""

from __future__ import annotations

import io

import pytest

from kg.errors import Place, QueryError
from kg.query.readers.messages import Call, failure, frame, received


def test_requests_come_one_by_one_and_end() -> None:
    """Each request is received whole; one cut within its prefix is dropped."""
    requests = io.BytesIO(frame(Call("first")) + frame(b"second") + b"\0")
    assert [received(requests) for _ in range(3)] == [Call("first"), b"second", None]


@pytest.mark.parametrize(
    ("error", "code"),
    [
        (QueryError("KG512", "other data"), "KG512"),
        (MemoryError(), "KG507"),
        (RuntimeError("can't start new thread"), "KG507"),
        (OSError(5, "Input/output error"), "KG303"),
        (OSError(28, "No space left on device"), "KG304"),
        (RuntimeError("Corruption: block checksum mismatch"), "KG303"),
        (RuntimeError("unforeseen"), "KG900"),
        (KeyError("unforeseen"), "KG900"),
    ],
)
def test_failures_have_codes(error: Exception, code: str) -> None:
    """Each failure has a code of its own; a defect is never reported as an error in the request."""
    assert failure(error, "update").error().code == code


def test_what_is_unforeseen_is_printed(capsys: pytest.CaptureFixture[str]) -> None:
    """A defect is written to standard error with its place in the program, other errors are not."""
    failure(QueryError("KG501", "unknown", place=Place("query", 1, 2)), "query")
    assert not capsys.readouterr().err
    failure(KeyError("unforeseen"), "query")
    assert "KeyError: 'unforeseen'" in capsys.readouterr().err
