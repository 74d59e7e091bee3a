"""Expressions of `$(eval ...)` mean what they mean in Python, and end soon whatever they say."""

from __future__ import annotations

import contextlib
import math
import re
from typing import Any

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from kg.extract.launch.ros1.expression import ExpressionError, NotKnownError, UnsupportedError, evaluate_expression
from kg.extract.launch.ros1.texts import HOLE

NAMES = {"x": 3, "y": "text", "z": 2.5, "unknown": HOLE, "partly": f"a{HOLE}"}
ERRORS = (ExpressionError, UnsupportedError, NotKnownError)


def value_of(source: str) -> Any:
    """Return the value with a few names."""

    def look_up(name: str) -> object:
        if name not in NAMES:
            raise ExpressionError(f"name '{name}' is not defined")
        return NAMES[name]

    return evaluate_expression(source, look_up, {"arg": lambda name: NAMES[name]})


atoms = st.one_of(
    st.integers(-20, 20).map(str),
    st.floats(-10, 10).map(lambda number: repr(round(number, 2))),
    st.sampled_from(["x", "y", "z", "True", "False", "None", "'ab'", "''", "pi", "arg('x')"]),
)


def compound(inner: st.SearchStrategy[str]) -> st.SearchStrategy[str]:
    """Return expressions made of smaller ones."""
    operators = ["+", "-", "*", "/", "//", "%", "==", "!=", "<", "<=", ">", ">=", "and", "or", "in", "not in", "**"]
    pairs = st.tuples(inner, st.sampled_from(operators), inner).map(lambda one: f"({one[0]} {one[1]} {one[2]})")
    calls = st.tuples(
        st.sampled_from(["abs", "bool", "float", "int", "len", "str", "round", "sqrt", "not ", "-"]), inner
    )
    methods = st.tuples(inner, st.sampled_from(["upper()", "startswith('a')", "split('b')", "replace('a', 'c')"]))
    return st.one_of(
        pairs,
        calls.map(lambda one: f"({one[0]}({one[1]}))"),
        methods.map(lambda one: f"str({one[0]}).{one[1]}"),
        st.tuples(inner, inner, inner).map(lambda one: f"({one[0]} if {one[1]} else {one[2]})"),
        st.lists(inner, max_size=3).map(lambda items: f"[{', '.join(items)}]"),
        st.tuples(inner, inner).map(lambda one: f"str({one[0]})[{one[1]}]"),
        st.tuples(inner, inner).map(lambda one: f"[{one[0]}, {one[1]}][0:1]"),
    )


@given(st.recursive(atoms, compound, max_leaves=8))
@settings(max_examples=300, deadline=None)
def test_agrees_with_python(source: str) -> None:
    """An expression has the value that Python gives it, or is wrong where Python raises an error."""
    names = {**vars(math), **NAMES, "arg": NAMES.__getitem__}
    try:
        expected = eval(source, {}, names)  # noqa: S307 - the expressions are made above
    except (ArithmeticError, AttributeError, LookupError, TypeError, ValueError):
        with pytest.raises((ExpressionError, UnsupportedError)):
            value_of(source)
        return
    try:
        found = value_of(source)
    except UnsupportedError as error:
        assert re.search("large|power|format", str(error)), source  # noqa: PT017 - most examples raise nothing
        return
    assert repr(found) == repr(expected)


@given(st.text(alphabet="x'()[]+-*/%<>=., 0123456789anotrifelsuchpd{}:\\\"\n", max_size=60) | st.text(max_size=40))
@settings(max_examples=300, deadline=None)
def test_never_raises_anything_else(source: str) -> None:
    """Whatever stands in an expression, it has a value or one of three errors."""
    with contextlib.suppress(*ERRORS):
        value_of(source)


@pytest.mark.parametrize(
    "source",
    [
        "9**9**9**9",
        "'a' * 10**10",
        "[[1] * 1000] * 1000",
        "factorial(10**9)",
        "1 << 10**10",
        "round(7, -10**9)",
        "'%999999999d' % 1",
        "('x' * 60000).replace('x', 'y' * 60000)",
        "('x' * 60000).join(['a'] * 20000)",
        "('%s' * 900) % (('x' * 60000,) * 900)",
        "(" * 500 + ")" * 500,
        "-" * 1999 + "1",
        "not " * 400 + "1",
        "+".join("1" * 999),
        "1" * 3000,
        "[x for x in 'ab']",
        "(lambda: 1)()",
        "open('/etc/passwd')",
        "'{0.real}'.format(1)",
        "len",
        "str(x=1)",
        "max(*[1, 2])",
        "b'bytes'",
        "1j",
        "(-8) ** 0.5",
        "x.real",
    ],
)
def test_large_or_strange_is_refused(source: str) -> None:
    """What would take long, grow large or is not of the grammar is refused."""
    with pytest.raises((UnsupportedError, ExpressionError)):
        value_of(source)


@pytest.mark.parametrize(
    ("source", "value"),
    [
        ("'a' + partly", f"aa{HOLE}"),
        ("unknown + '/x'", f"{HOLE}/x"),
        ("1 if partly else 2", 1),
        ("True or unknown", True),
        ("false and unknown", False),
        ("str(partly)", f"a{HOLE}"),
    ],
)
def test_texts_known_in_part(source: str, value: object) -> None:
    """Texts with unknown parts can be joined, and decide nothing but that they are not empty."""
    assert value_of(source) == value


@pytest.mark.parametrize(
    "source", ["unknown == 'x'", "not unknown", "unknown + 1", "partly.upper()", "[unknown][0] * 2"]
)
def test_unknown_stays_unknown(source: str) -> None:
    """What depends on an unknown value is not known."""
    with pytest.raises(NotKnownError):
        value_of(source)
