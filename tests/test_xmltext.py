from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from kg.xmltext import line_of, parse_xml


def test_well_formed() -> None:
    """Elements of a well-formed text have their lines and no problem."""
    result = parse_xml(b'<?xml version="1.0" encoding="latin-1"?>\n<a>\n<b>\xc3\xa4</b></a>')
    assert result.problem is None
    assert result.root is not None
    assert result.root.findtext("b") == "ä"
    assert [line_of(element) for element in result.root.iter()] == [2, 3]


@pytest.mark.parametrize(
    ("text", "code", "line"),
    [
        (b"", "KG116", 1),
        (b"no xml", "KG116", 1),
        (b"<a>\n<b></a>", "KG116", 2),
        (b"<a>&undefined;</a>", "KG116", 1),
        (b"<a>" * 5000, "KG114", 1),
        (b'<!DOCTYPE a [\n<!ENTITY x SYSTEM "file:///etc/passwd">]><a>&x;</a>', "KG116", 2),
        (b'<!DOCTYPE a [<!ENTITY x "ha"><!ENTITY y "&x;&x;&x;">]><a>&y;</a>', "KG116", 1),
    ],
)
def test_malformed_or_hostile(text: bytes, code: str, line: int) -> None:
    """A malformed text, a deep one or one that defines entities is a problem with its line."""
    result = parse_xml(text)
    assert result.problem is not None
    assert (result.problem[0], result.problem[2]) == (code, line)


def test_recovery() -> None:
    """Elements before a fault are read."""
    root = parse_xml(b"<package><name>a</name><broken></package>").root
    assert root is not None
    assert root.findtext("name") == "a"


@given(st.binary(max_size=200))
def test_any_bytes(data: bytes) -> None:
    """Any bytes give a root, a problem, or both."""
    result = parse_xml(data)
    assert result.root is not None or result.problem is not None
