from __future__ import annotations

from contextlib import suppress

import pytest
from hypothesis import given
from hypothesis import strategies as st

from kg.extract.launch.expressions import BUILTINS, MATHEMATICS, ExpressionError, evaluate_expression

NUMBERS = st.integers(-9, 9).map(lambda number: f"({number})")
WORDS = st.sampled_from(["''", "'a'", "'ab'", "'True'"])
PLAIN = st.one_of(NUMBERS, WORDS, st.sampled_from(["True", "False", "None", "x", "word"]))
KNOWN = {"x": 3, "word": "b"}


def larger(inner: st.SearchStrategy[str]) -> st.SearchStrategy[str]:
    """Expressions one level deeper."""
    binary = st.sampled_from(["+", "-", "*", "/", "//", "%", "==", "!=", "<", ">=", "in", "and", "or", "is not"])
    return st.one_of(
        st.builds("({} {} {})".format, inner, binary, inner),
        st.builds("({} {})".format, st.sampled_from(["not", "-"]), inner),
        st.builds("({} if {} else {})".format, inner, inner, inner),
        st.builds("[{}, {}][{}]".format, inner, inner, inner),
        st.builds("{}({})".format, st.sampled_from(["str", "len", "bool", "int", "abs"]), inner),
        st.builds("str({}).{}()".format, inner, st.sampled_from(["upper", "strip", "split"])),
        st.builds("({} < {} < {})".format, inner, inner, inner),
    )


EXPRESSIONS = st.recursive(PLAIN, larger, max_leaves=8)


@pytest.mark.filterwarnings("ignore::SyntaxWarning")
@given(EXPRESSIONS)
def test_agrees_with_python(text: str) -> None:
    """An expression has the value that Python gives it, and fails where Python fails."""
    try:
        expected: object = eval(text, {"__builtins__": {}}, {**BUILTINS, **KNOWN})  # noqa: S307  (made of a safe grammar)
    except Exception:  # noqa: BLE001  (whatever Python raises)
        with pytest.raises(ExpressionError):
            evaluate_expression(text, KNOWN, BUILTINS)
        return
    found = evaluate_expression(text, KNOWN, BUILTINS)
    assert (type(found), found) == (type(expected), expected)


@given(st.text("ab1+-*/()[]'\".,:=<> \n{}%", max_size=40))
def test_any_text_has_a_value_or_is_refused(text: str) -> None:
    """No text makes the evaluator fail in any other way than with its own error."""
    with suppress(ExpressionError):
        evaluate_expression(text, {"a": 1, "b": "x"}, BUILTINS)


@pytest.mark.parametrize(
    "text",
    [
        "9**9**9",
        "1 << 99999",
        "'x' * 10**9",
        "['x' * 50000] * 50000",
        "('x' * 50000).replace('', 'y' * 50000)",
        "('y' * 50000).join(['x'] * 50000)",
        "'%999999999d' % 1",
        "f'{1:>999999}'",
        "[" * 90 + "]" * 90,
        "-" * 9000 + "1",
        "a" + ".b" * 9000,
        "1 + " * 9000 + "1",
        "x" * 30_000,
    ],
)
def test_what_would_cost_too_much_is_refused(text: str) -> None:
    """Exponents, repetitions, formats, depth and length are bounded."""
    with pytest.raises(ExpressionError):
        evaluate_expression(text, {"x": 1}, BUILTINS)


@pytest.mark.parametrize(
    "text",
    [
        "__import__('os')",
        "''.__class__",
        "(lambda: 1)()",
        "[y for y in (1, 2)]",
        "open('f')",
        "x.real",
        "str.format('{}', 1)",
        "'{0.x}'.format(1)",
        "(y := 1)",
        "b'bytes'",
        "print",
        "factorial(9)",
    ],
)
def test_what_is_not_known_is_refused(text: str) -> None:
    """Names, attributes, methods and forms that are not given cannot be used."""
    with pytest.raises(ExpressionError):
        evaluate_expression(text, {"x": 1, **MATHEMATICS}, BUILTINS)


def test_dotted_names_are_known_where_they_are_given() -> None:
    """A dotted name is looked up as a whole, functions as well."""
    names = {f"math.{name}": value for name, value in MATHEMATICS.items()}
    assert evaluate_expression("math.floor(math.pi)", names, {}) == 3
