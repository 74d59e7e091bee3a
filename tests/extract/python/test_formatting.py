from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from kg.extract.python.entities import Items, Table
from kg.extract.python.formatting import STRING_METHODS, decode_literal, format_braces, format_percent
from kg.extract.values import HOLE, Number, Text, Truth, Unknown

PIECES = st.text("ab/_-.", max_size=5)


@given(st.text("abc'\"\\\n\tä{}%", max_size=12))
def test_literals_are_decoded_as_python_does(text: str) -> None:
    """The body of a literal written by `repr` gives the text again."""
    written = repr(text)
    assert decode_literal(written[0], written[1:-1]) == text


@pytest.mark.parametrize(
    ("prefix", "body", "text"),
    [
        ('r"', "a\\n", "a\\n"),
        ("ur'", "\\d", "\\d"),
        ("b'", "a\\x41", "aA"),
        ('"""', "a\nb", "a\nb"),
        ("'", "\\N{bad", "\\N{bad"),
    ],
)
def test_prefixes_and_bad_escapes(prefix: str, body: str, text: str) -> None:
    """Raw literals keep their backslashes, and so do escapes that Python refuses."""
    assert decode_literal(prefix, body) == text


@given(st.lists(st.tuples(PIECES, st.one_of(PIECES, st.integers(-99, 99))), max_size=4))
def test_percent_is_python_s(parts: list[tuple[str, str | int]]) -> None:
    """`%` with as many directives as values gives what Python gives."""
    template = "".join(f"{before}%{'s' if isinstance(value, str) else '+4d'}%%" for before, value in parts)
    values = tuple(value for _, value in parts)
    given_values = Items(tuple(Text.of(v) if isinstance(v, str) else Number(v, str(v)) for v in values))
    assert format_percent(Text.of(template), given_values).known == template % values


@given(st.lists(PIECES, min_size=1, max_size=4), st.data())
def test_format_is_python_s(words: list[str], data: st.DataObject) -> None:
    """`str.format` with fields by number and by name gives what Python gives."""
    order = data.draw(st.lists(st.integers(0, len(words) - 1), max_size=4))
    template = "/".join(f"{{{index}:_<6}}" for index in order) + "{{}}{name}"
    made = format_braces(Text.of(template), [Text.of(word) for word in words], {"name": Truth(True)})
    assert made.known == template.format(*words, name=True)


def test_what_is_missing_is_a_hole() -> None:
    """Too few values, values that are not known and directives that are not computed leave holes."""
    assert format_percent(Text.of("a%s/%s"), Items((Text.of("b"),))).pattern == "ab/{}"
    assert format_percent(Text.of("%(a)s/%(b)s"), Table(((Text.of("a"), Text.of("x")),))).pattern == "x/{}"
    assert format_percent(Text.of("%.*f"), Items((Number(1, "1"),))).known is None
    assert format_braces(Text.of("{}/{x}"), [Unknown("why")], {}).pattern is None
    assert format_braces(Text.of("{"), [], {}).parts == (HOLE,)


@pytest.mark.parametrize("name", sorted(STRING_METHODS))
def test_methods_are_those_of_str(name: str) -> None:
    """Every method of the table does to a known string what `str` does."""
    given_words = ["a", "b"] if name == "replace" else []
    expected = "A/a/" if name in {"encode", "decode"} else getattr("A/a/", name)(*given_words) if name not in {
        "removeprefix", "removesuffix"} else "A/a/"  # fmt: skip
    arguments = given_words or (["x"] if name.startswith("remove") else [])
    assert STRING_METHODS[name]("A/a/", arguments) == expected
