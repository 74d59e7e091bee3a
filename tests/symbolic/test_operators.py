from __future__ import annotations

import pytest

from kg.symbolic.operators import NULL, compute, negate, negated_term, negative, truth
from kg.symbolic.values import (
    OUTSIDE,
    Enumerator,
    Guard,
    Kind,
    Mapping,
    Number,
    Object,
    Sequence,
    Text,
    Truth,
    Unknown,
    Value,
    number,
)

FAST, SLOW = Enumerator("Mode::FAST"), Enumerator("Mode::SLOW")
PARAMETER = Unknown("it is a parameter", "~use_imu")
QUEUE = Unknown(f"qos::KEEP_LAST {OUTSIDE}")
ONE, TWO = number(1), number(2)


def listed(*items: Value) -> Sequence:
    """Return a list of values."""
    return Sequence(items)


@pytest.mark.parametrize(
    ("left", "right", "equal"),
    [
        (FAST, FAST, True),
        (FAST, SLOW, False),
        (listed(ONE, TWO), listed(ONE, TWO), True),
        (listed(ONE), listed(ONE, TWO), False),
        (listed(TWO, ONE), listed(ONE, TWO), False),
        (Text.of("a"), NULL, False),
        (NULL, NULL, True),
        (ONE, NULL, False),
        (QUEUE, Unknown(f"qos::KEEP_LAST {OUTSIDE}"), True),
        (QUEUE, Unknown(f"qos::KEEP_ALL {OUTSIDE}"), False),
    ],
)
def test_values_are_equal_or_not(left: Value, right: Value, equal: bool) -> None:  # noqa: FBT001 - a column of the table
    """`==` and `!=` give opposite results for enumerators, foreign constants, lists and null."""
    assert compute("==", (left, right)) == Truth(equal)
    assert compute("!=", (left, right)) == Truth(not equal)


def test_a_list_that_may_have_more_items_is_compared_with_none() -> None:
    """The result is unknown, even where all known items are equal."""
    assert isinstance(compute("==", (Sequence((ONE,), open=True), listed(ONE))), Unknown)


def test_a_subscriber_that_may_be_empty_is_compared_with_null() -> None:
    """An object from outside may be null, so the comparison is unknown."""
    assert isinstance(compute("==", (Object(Kind(("Node",)), created=False), NULL)), Unknown)


@pytest.mark.parametrize(
    ("item", "container", "found"),
    [
        (ONE, listed(ONE, TWO), True),
        (number(3), listed(ONE, TWO), False),
        (Text.of("b"), Text.of("abc"), True),
        (Text.of("d"), Text.of("abc"), False),
        (Text.of("k"), Mapping(((Text.of("k"), ONE),)), True),
        (Text.of("l"), Mapping(((Text.of("k"), ONE),)), False),
    ],
)
def test_an_item_is_in_a_container(item: Value, container: Value, found: bool) -> None:  # noqa: FBT001 - a column
    """`in` finds items of lists, keys of maps and parts of texts."""
    assert compute("in", (item, container)) == Truth(found)


@pytest.mark.parametrize(
    ("item", "container"),
    [
        (ONE, Sequence((TWO,), open=True)),
        (ONE, listed(Unknown("it is read"))),
        (Text.of("a"), Text.hole("it is read")),
        (Text.hole("it is read"), Text.of("a")),
        (Text.of("a"), Text(("abc",), parameter="~name")),
    ],
)
def test_an_item_may_be_in_what_is_not_known(item: Value, container: Value) -> None:
    """An open list, an unknown item and a parameter leave `in` unknown."""
    assert isinstance(compute("in", (item, container)), Unknown)


def test_repeated_lists_and_texts() -> None:
    """`*` repeats the items of a list and the letters of a text."""
    assert compute("*", (listed(ONE, TWO), TWO)) == listed(ONE, TWO, ONE, TWO)
    assert compute("*", (Text.of("ab"), TWO)) == Text.of("abab")


def test_united_maps_are_open_if_one_is() -> None:
    """`|` keeps the last value of a key; a part that is unknown or open may add keys."""
    key = Text.of("k")
    old, new = Mapping(((key, ONE),)), Mapping(((key, TWO),))
    assert compute("|", (old, new)) == new
    for other in (Mapping((), open=True), Unknown("it is read")):
        found = compute("|", (old, other))
        assert isinstance(found, Mapping)
        assert found.open


@pytest.mark.parametrize(("left", "right", "written"), [("7", "2", "3"), ("-7", "2", "-3")])
def test_whole_numbers_are_divided_towards_zero(left: str, right: str, written: str) -> None:
    """`/` of C++ truncates whole numbers."""
    assert compute("/", (number(float(left)), number(float(right)))) == number(float(written))


@pytest.mark.parametrize("written", ["2.5", "3"])
def test_the_opposite_of_the_opposite_is_the_number(written: str) -> None:
    """A number changes its sign and its spelling, and keeps its parameter."""
    value = Number(float(written), written, "~gain")
    opposite = negative(value)
    assert opposite == Number(-float(written), f"-{written}", "~gain")
    assert negative(opposite) == value


@pytest.mark.parametrize("term", ["use_imu", "!use_imu", "argc==2", "argc<3", "argc>=1"])
def test_the_opposite_of_the_opposite_of_a_term_is_the_term(term: str) -> None:
    """Negating a term twice gives the term, and once something else."""
    assert negated_term(term) != term
    assert negated_term(negated_term(term)) == term


def test_the_opposite_of_conditions() -> None:
    """A negated guard has the opposite term; the opposite of an unknown parameter is not the parameter."""
    assert negate(Truth(True)) == Truth(False)
    assert negate(Guard(("use_imu",))) == Guard(("!use_imu",))
    found = negate(PARAMETER)
    assert isinstance(found, Unknown)
    assert found.parameter is None


def test_a_number_of_a_parameter_is_no_certain_condition() -> None:
    """Zero is false, but a parameter whose default is zero can have another value; the condition is not its value."""
    assert truth(number(0)) == Truth(False)
    found = truth(Number(0, "0", "~rate"))
    assert isinstance(found, Unknown)
    assert found.parameter is None
