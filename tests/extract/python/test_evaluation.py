"""Expressions in texts of launch files have their meaning in Python, and terminate soon."""

from __future__ import annotations

import contextlib
import math
import re
from typing import Any

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from kg.extract.python.evaluation import (
    HOLE,
    MISSING,
    Dialect,
    ExpressionError,
    UnknownValueError,
    UnsupportedError,
    evaluate_text,
)

NAMES: dict[str, object] = {"x": 3, "y": "text", "z": 2.5, "empty": "", "unknown": HOLE, "partly": f"a{HOLE}"}
DIALECT = Dialect(arguments=lambda name: NAMES.get(name, MISSING), functions={"arg": NAMES.__getitem__})

ERRORS = (ExpressionError, UnsupportedError, UnknownValueError)


def value_of(source: str) -> Any:
    """Return the value with a few names."""
    return evaluate_text(source, DIALECT)


ATOMS = st.one_of(
    st.integers(-20, 20).map(str),
    st.floats(-10, 10).map(lambda number: repr(round(number, 2))),
    st.sampled_from(["x", "y", "z", "empty", "True", "False", "None", "'ab'", "''", "'True'", "pi", "arg('x')"]),
)
OPERATORS = st.sampled_from(
    [
        *("+", "-", "*", "/", "//", "%", "**", "&", "|", "^", "<<", ">>"),
        *("==", "!=", "<", "<=", ">", ">=", "and", "or", "in", "not in"),
    ]
)


def compound(inner: st.SearchStrategy[str]) -> st.SearchStrategy[str]:
    """Return expressions made of smaller ones."""
    functions = st.sampled_from(["abs", "bool", "float", "int", "len", "str", "round", "sqrt", "list", "sum", "max"])
    methods = st.sampled_from(["upper()", "strip()", "split()", "startswith('a')", "split('b')", "replace('a', 'c')"])
    return st.one_of(
        st.builds("({} {} {})".format, inner, OPERATORS, inner),
        st.builds("({}{})".format, st.sampled_from(["not ", "-", "~", "+", "None is not "]), inner),
        st.builds("({}({}))".format, functions, inner),
        st.builds("str({}).{}".format, inner, methods),
        st.builds("({} if {} else {})".format, inner, inner, inner),
        st.builds("({} < {} < {})".format, inner, inner, inner),
        st.lists(inner, max_size=3).map(lambda items: f"[{', '.join(items)}]"),
        st.lists(inner, min_size=1, max_size=3).map(lambda items: f"({', '.join(items)},)"),
        st.builds("str({})[{}]".format, inner, inner),
        st.builds("[{}, {}][{}]".format, inner, inner, inner),
        st.builds("[{}, {}][0:1]".format, inner, inner),
        st.builds("{{'a': {}, 2: {}}}[{}]".format, inner, inner, inner),
        st.builds("f'{{x}}:{{{}!r}}'".format, st.sampled_from(["x", "y", "z", "7"])),
    )


@pytest.mark.filterwarnings("ignore::SyntaxWarning")
@given(st.recursive(ATOMS, compound, max_leaves=8))
@settings(max_examples=400, deadline=None)
def test_agrees_with_python(source: str) -> None:
    """An expression has its Python value, or is an error if Python raises one."""
    names = {**vars(math), **NAMES, "arg": NAMES.__getitem__}
    try:
        expected = eval(source, names)  # noqa: S307 - the expressions are made above
    except (ArithmeticError, AttributeError, LookupError, TypeError, ValueError):
        with pytest.raises((ExpressionError, UnsupportedError)):
            value_of(source)
        return
    try:
        found = value_of(source)
    except UnsupportedError as error:
        assert re.search("large|format|type complex|type function", str(error)), source  # noqa: PT017 - most raise none
        return
    assert repr(found) == repr(expected)


@pytest.mark.filterwarnings("ignore::SyntaxWarning")
@given(st.recursive(ATOMS | st.sampled_from(["unknown", "partly"]), compound, max_leaves=8), st.sampled_from(["", "b"]))
@settings(max_examples=400, deadline=None)
def test_what_is_certain_holds_for_every_text(source: str, text: str) -> None:
    """Apart from holes, an expression with an unknown text gives Python's result for any text in its place."""
    names = {**vars(math), **NAMES, "unknown": text, "partly": f"a{text}", "arg": NAMES.__getitem__}
    try:
        found = value_of(source)
        expected = eval(source, names)  # noqa: S307 - the expressions are made above
    except (ArithmeticError, AttributeError, LookupError, TypeError, ValueError, *ERRORS):
        return
    pattern = re.escape(repr(found)).replace(re.escape(repr(HOLE)[1:-1]), ".*")
    assert re.fullmatch(pattern, repr(expected), re.DOTALL)


@given(st.text(alphabet="x'()[]+-*/%<>=., 0123456789anotrifelsuchpd{}:\\\"\n", max_size=60) | st.text(max_size=40))
@settings(max_examples=300, deadline=None)
def test_never_raises_anything_else(source: str) -> None:
    """Any expression has a value or one of three errors."""
    with contextlib.suppress(*ERRORS):
        value_of(source)


@pytest.mark.parametrize(
    "source",
    [
        "9**9**9**9",
        "2**(1 << 14)",
        "1 << 10**10",
        "1 << 99999",
        "factorial(10**9)",
        "round(7, -10**9)",
        "1" * 3000,
        "'a' * 10**10",
        "[[1] * 1000] * 1000",
        "['x' * 50000] * 50000",
        "('x' * 60000).replace('x', 'y' * 60000)",
        "('x' * 50000).replace('', 'y' * 50000)",
        "('x' * 60000).join(['a'] * 20000)",
        "'%999999999d' % 1",
        "'%*d' % (999999999, 1)",
        "('%s' * 900) % (('x' * 60000,) * 900)",
        "f'{1:>999999}'",
        "'x'.ljust(999999)",
        "[" * 90 + "]" * 90,
        "-" * 1999 + "1",
        "-" * 9000 + "1",
        "not " * 400 + "1",
        "x" + ".b" * 9000,
        "x" * 30_000,
    ],
)
def test_large_is_refused(source: str) -> None:
    """Exponents, repetitions, formats, loops, depth and length are bounded."""
    with pytest.raises((UnsupportedError, ExpressionError)):
        value_of(source)


@pytest.mark.parametrize(
    "source",
    [
        "__import__('os')",
        "open('/etc/passwd')",
        "print",
        "len",
        "str(x=1)",
        "''.__class__",
        "x.real",
        "'{0.real}'.format(1)",
        "str.format('{}', 1)",
        "(lambda: 1)()",
        "[one for one in (1, 2)]",
        "(y := 1)",
        "1j",
        "(-8) ** 0.5",
        "absent",
        "'\\0'",
        "'\\ud800'",
        "chr(0xd800)",
        "'%c' % 0xd800",
        "f'{55296:c}'",
    ],
)
def test_strange_is_refused(source: str) -> None:
    """Names, attributes, methods and values that launch files do not need are rejected."""
    with pytest.raises((UnsupportedError, ExpressionError)):
        value_of(source)


@pytest.mark.parametrize(
    ("source", "value"),
    [
        ("max(*[1, 2])", 2),
        ("factorial(9)", 362880),
        ("math.floor(math.pi)", 3),
        ("f'{z:.2f}'", "2.50"),
        ("'-'.join(sorted({'b', 'a'}))", "a-b"),
    ],
)
def test_python_is_evaluated(source: str, value: object) -> None:
    """Spread arguments, modules and formats are those of Python."""
    assert value_of(source) == value


@pytest.mark.parametrize(
    ("source", "value"),
    [
        ("'a' + partly", f"aa{HOLE}"),
        ("unknown + '/x'", f"{HOLE}/x"),
        ("1 if partly else 2", 1),
        ("1 if unknown == 'x' else 1", 1),
        ("True or unknown", True),
        ("False and unknown", False),
        ("str(partly)", f"a{HOLE}"),
        ("[partly, 'b'][1]", "b"),
    ],
)
def test_texts_known_in_part(source: str, value: object) -> None:
    """Texts with unknown parts can be joined, and are known only not to be empty."""
    assert value_of(source) == value


@pytest.mark.parametrize(
    "source", ["unknown == 'x'", "not unknown", "unknown + 1", "partly.upper()", "[unknown][0] * 2", "arg('unknown')*2"]
)
def test_unknown_stays_unknown(source: str) -> None:
    """A value that depends on an unknown one is unknown."""
    with pytest.raises(UnknownValueError):
        value_of(source)


def test_arguments_hide_functions_of_python() -> None:
    """Names of launch arguments such as `map` are common; names of `math` are the mathematical ones."""
    dialect = Dialect(arguments=lambda name: {"map": "m.yaml", "e": 1}.get(name, MISSING))
    assert evaluate_text("map + str(floor(e))", dialect) == "m.yaml2"
