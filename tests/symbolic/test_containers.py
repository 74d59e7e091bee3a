from __future__ import annotations

import pytest

from kg.symbolic import form
from kg.symbolic.containers import (
    COMMAND_LINE,
    counted,
    element,
    elements,
    is_unknown_parameter,
    part_of,
    with_element,
)
from kg.symbolic.values import Mapping, Sequence, Text, Unknown, Value, number

A, B = Text.of("a"), Text.of("b")
ONE, TWO = number(1), number(2)


def test_arguments_of_the_program_are_parameters() -> None:
    """`argv[2]` is the parameter of that name, with a reason; `argv[i]` stands for any."""
    found = element(COMMAND_LINE, TWO)
    assert isinstance(found, Text)
    assert (found.parameter, found.reason) == ("argv[2]", "it is the argument argv[2] of the command line")
    unknown = element(COMMAND_LINE, Unknown("it is counted"))
    assert isinstance(unknown, Text)
    assert unknown.parameter == "argv[]"


def test_part_of_a_parameter_has_a_reason() -> None:
    """The reason names the parameter."""
    assert part_of("~topics[]").reason == "it is part of a parameter: ~topics[]"


def test_only_a_parameter_without_a_known_default_is_unknown() -> None:
    """A text with a default is known, one with a hole is not."""
    assert is_unknown_parameter(Unknown("it is a parameter", "~topic"))
    assert is_unknown_parameter(Text.hole("it is a parameter", parameter="~topic"))
    assert not is_unknown_parameter(Text(("scan",), parameter="~topic"))
    assert not is_unknown_parameter(Unknown("it is read"))


def test_an_empty_parameter_has_one_element_of_its_kind() -> None:
    """A list has a value, a map has a pair of key and value."""
    (one,) = elements(Sequence((), parameter="~topics"))
    assert one == part_of("~topics[]")
    (pair,) = elements(Mapping((), parameter="~topics"))
    assert isinstance(pair, Sequence)
    assert [getattr(item, "parameter", None) for item in pair.items] == ["~topics[key]", "~topics[]"]


@pytest.mark.parametrize(
    ("key", "expected"),
    [
        (Sequence((A, ONE)), ONE),
        (Sequence((A, TWO)), TWO),
        (Sequence((A,)), Unknown("the map has no such key")),
        (ONE, Unknown("the map has no such key")),
    ],
)
def test_keys_may_be_tuples(key: Value, expected: Value) -> None:
    """Tuples are the same key if they have as many items, and all of them are equal."""
    of = Mapping(((Sequence((A, ONE)), ONE), (Sequence((A, TWO)), TWO)))
    assert element(of, key) == expected


def test_a_text_is_not_the_key_of_a_number() -> None:
    """A key of another type is certainly another key."""
    assert element(Mapping(((A, ONE),)), ONE) == Unknown("the map has no such key")


def test_a_key_that_is_not_known_can_be_any() -> None:
    """The values of all keys are possible, but not if one key is certainly equal."""
    of = Mapping(((A, ONE), (B, TWO)))
    found = element(of, Text.hole("it is read"))
    assert set(getattr(found, "items", ())) == {ONE, TWO}
    assert element(of, B) == TWO


def test_an_element_is_replaced_or_added() -> None:
    """A key that is there gets the new value, another one is added."""
    of = Mapping(((A, ONE),))
    assert with_element(of, A, TWO) == Mapping(((A, TWO),))
    assert with_element(of, B, TWO) == Mapping(((A, ONE), (B, TWO)))


INDEX = form.Name(1, ("i",))
STEP = form.Literal(1, 1.0, "1")


@pytest.mark.parametrize(
    ("step", "counts"),
    [
        (form.Unary(1, "++", INDEX), True),
        (form.Unary(1, "--", INDEX), True),
        (form.Unary(1, "-", INDEX), False),
        (form.Assign(1, INDEX, STEP, "+"), True),
        (form.Assign(1, INDEX, STEP, "-"), True),
        (form.Assign(1, INDEX, STEP, "*"), False),
        (form.Assign(1, INDEX, form.Binary(1, "+", (INDEX, STEP))), True),
        (form.Assign(1, INDEX, form.Binary(1, "-", (INDEX, STEP))), True),
        (form.Assign(1, INDEX, form.Binary(1, "*", (INDEX, STEP))), False),
        (form.Assign(1, INDEX, form.Binary(1, "+", (form.Name(1, ("j",)), STEP))), False),
        (form.Assign(1, INDEX, STEP), False),
    ],
)
def test_a_loop_counts_what_it_changes_by_steps(step: form.Expression, counts: bool) -> None:  # noqa: FBT001 - a column
    """A variable that is incremented or decremented in any form is counted, another assignment is not."""
    loop = form.Loop(1, form.Block(1, (form.Step(1, step),)))
    assert [one is INDEX for one in counted(loop)] == ([True] if counts else [])
