"""Formatting of known texts equals that of Python."""

from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from kg.extract.python.texts import braces, method, percent
from kg.holes import Hole
from kg.symbolic.values import Either, Mapping, Number, Sequence, Text, Unknown, Value, alternatives

WORDS = st.text("abz/_~ %{}'\"ä0", max_size=6)


def value_of(plain: str | int) -> Value:
    """Return a plain value as an abstract one."""
    return Text.of(plain) if isinstance(plain, str) else Number(float(plain), str(plain))


@given(WORDS, WORDS, st.integers(-20, 300))
def test_percent_formats_as_python_does(lead: str, word: str, number: int) -> None:
    """`%` with a tuple and with a dictionary gives the text of Python."""
    template = lead.replace("%", "%%") + "%s-%03d%%"
    values = Sequence((value_of(word), value_of(number)))
    assert percent(Text.of(template), values) == Text.of(template % (word, number))
    named = Mapping(((Text.of("k"), value_of(word)),))
    assert percent(Text.of("a%(k)5sb"), named) == Text.of(f"a{word:>5}b")


@given(WORDS, WORDS, st.integers(-20, 300))
def test_braces_format_as_python_does(lead: str, word: str, number: int) -> None:
    """`str.format` gives the text of Python."""
    template = lead.replace("{", "{{").replace("}", "}}") + "{1}{0:>4}{name}"
    found = braces(Text.of(template), [value_of(number), value_of(word)], {"name": value_of(number)})
    assert found == Text.of(template.format(number, word, name=number))


@pytest.mark.parametrize("name", ["strip", "lower", "upper", "title", "capitalize", "lstrip", "rstrip"])
@given(WORDS)
def test_methods_do_what_python_does(name: str, word: str) -> None:
    """Methods of `str` give the text of Python."""
    assert method(Text.of(word), name, []) == Text.of(getattr(word, name)())


def test_an_unknown_part_stays_a_hole() -> None:
    """Unknown parts are holes in a text."""
    found = percent(Text.of("robot_%s/%s"), Sequence((Unknown("x"), Text.of("scan"))))
    assert isinstance(found, Text)
    assert found.parts == ("robot_", Hole(), "/scan")


def test_each_alternative_is_formatted() -> None:
    """A value with alternatives gives one text for each."""
    found = braces(Text.of("{}/x"), [Either((Text.of("a"), Text.of("b")))], {})
    assert [one.exact for one in alternatives(found) if isinstance(one, Text)] == ["a/x", "b/x"]
