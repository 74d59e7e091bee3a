"""Tests of the content of requests: parameters and bodies."""

from __future__ import annotations

from urllib.parse import urlencode

import pytest
from hypothesis import given
from hypothesis import strategies as st

from kg.server.errors import RequestError
from kg.server.parameters import Parameters

TEXTS = st.text(st.characters(exclude_categories=["Cs"]), max_size=20)


@given(st.lists(st.tuples(TEXTS, TEXTS), max_size=8))
def test_any_pairs(pairs: list[tuple[str, str]]) -> None:
    """Names and values are decoded as they were sent, in the address and in a form."""
    written = urlencode(pairs).encode()
    for parameters in (Parameters(written), Parameters(b"", written)):
        assert sorted(parameters.pairs()) == sorted(pairs)


def test_twice() -> None:
    """A repeated parameter is rejected if one is expected, also if one is in the address."""
    with pytest.raises(RequestError, match="2 times"):
        Parameters(b"query=a", b"query=b").one("query")
    assert Parameters(b"g=a&g=b").all("g") == ("a", "b")


def test_not_in_utf8() -> None:
    """Input that is not UTF-8 is rejected."""
    with pytest.raises(RequestError, match="UTF-8"):
        Parameters(b"query=%FF")
    with pytest.raises(RequestError, match="UTF-8"):
        Parameters(b"", b"query=\xff")


@pytest.mark.parametrize("text", ["", "x", "-1", "nan", "inf", "1e999"])
def test_no_number(text: str) -> None:
    """Text other than a number within the bounds is rejected."""
    with pytest.raises(RequestError, match="timeout"):
        Parameters(urlencode({"timeout": text}).encode()).number("timeout")


@pytest.mark.parametrize("text", ["", "x", "-1", "1.5", "٣", "9" * 30, "0x10"])
def test_no_whole_number(text: str) -> None:
    """Text other than a whole number within the bounds is rejected."""
    with pytest.raises(RequestError, match="limit"):
        Parameters(urlencode({"limit": text}).encode()).whole("limit")


def test_numbers_and_flags() -> None:
    """Numbers and flags are parsed; a flag without a value is set."""
    parameters = Parameters(b"timeout=1.5&limit=10&stream&other=0&$a=1")
    assert parameters.number("timeout") == 1.5
    assert parameters.whole("limit") == 10
    assert parameters.flag("stream")
    assert not parameters.flag("other")
    assert not parameters.flag("absent")
    assert parameters.starting("$") == {"a": "1"}
    with pytest.raises(RequestError, match="neither"):
        parameters.flag("limit")
