from __future__ import annotations

from typing import TYPE_CHECKING

from hypothesis import given
from hypothesis import strategies as st

from kg.facts import Resolution
from kg.holes import Hole
from kg.symbolic import values as abstract
from kg.symbolic.values import (
    MOST_ALTERNATIVES,
    Either,
    Number,
    Sequence,
    Text,
    Truth,
    Unknown,
    Value,
    alternatives,
    combinations,
    concatenate,
    join,
    number,
    read_back,
    whole_parameter,
)

if TYPE_CHECKING:
    from random import Random

WORDS = st.text("ab/_~", min_size=1, max_size=4)
TEXTS = st.builds(Text.of, WORDS, st.sampled_from([Resolution.LITERAL, Resolution.CONSTANT]))
PARTIAL = st.builds(lambda before, after: concatenate(before, Unknown("it is foreign"), after), TEXTS, TEXTS)
NUMBERS = st.integers(-9, 9).map(number)
UNKNOWN = st.sampled_from([Unknown("it is foreign"), Unknown("it is computed")])
PARAMETERS = st.sampled_from([Unknown("it is a parameter", "~/topic"), Text.hole("it is a parameter", "", "~/topic")])
PLAIN = st.one_of(TEXTS, PARTIAL, NUMBERS, st.booleans().map(Truth))
VALUES = st.one_of(PLAIN, UNKNOWN, PARAMETERS)


def options(value: Value) -> set[Value]:
    """Return the alternatives of a value without their order."""
    return set(alternatives(value))


@given(VALUES)
def test_join_of_a_value_with_itself_is_the_value(value: Value) -> None:
    """Joining a value with itself changes nothing."""
    assert join(value) == value
    assert join(value, value) == value


@given(st.lists(VALUES, min_size=1, max_size=5))
def test_join_is_idempotent(values: list[Value]) -> None:
    """Joining a joined value with itself does not change it."""
    joined = join(*values)
    assert options(join(joined, joined)) == options(joined)


@given(st.lists(PLAIN, min_size=1, max_size=5), st.randoms())
def test_the_order_of_joined_values_does_not_matter(values: list[Value], random: Random) -> None:
    """Known values can be joined in any order, one by one or at once."""
    mixed = list(values)
    random.shuffle(mixed)
    step = mixed[0]
    for value in mixed[1:]:
        step = join(step, value)
    assert options(join(*mixed)) == options(join(*values)) == options(step) == set(values)


@given(st.lists(TEXTS, min_size=1, max_size=3), UNKNOWN)
def test_known_values_stay_beside_unknown_ones(values: list[Value], unknown: Value) -> None:
    """A value known in one branch remains if it is unknown in the other."""
    assert options(join(*values, unknown)) == set(values)


def test_alternatives_of_one_side_are_not_combined_with_the_other_side() -> None:
    """If the other branch does not know a value, the alternatives of this one are not combined with it."""
    name = abstract.options([join(Text.of("a"), Text.of("b")), Unknown("it is read")], "branch")
    topic = abstract.options([Text.of("here"), Text.of("there")], "branch")
    found = {(one, other) for one, other in combinations([name, topic])}
    assert found == {(Text.of("a"), Text.of("here")), (Text.of("b"), Text.of("here"))}


@given(WORDS)
def test_what_a_parameter_falls_back_to_is_its_default(word: str) -> None:
    """A parameter without default, or a text, is the parameter with that text as default."""
    joined = join(Unknown("it is a parameter", "~/topic"), Text.of(word))
    assert joined == Text.of(word, Resolution.PARAMETER_DEFAULT, "~/topic")


def test_too_many_alternatives_are_not_known() -> None:
    """More alternatives than the limit make an unknown value, with that reason."""
    texts = [Text.of(f"a{i}") for i in range(MOST_ALTERNATIVES + 1)]
    assert isinstance(join(*texts[:-1]), Either)
    found = join(*texts)
    assert isinstance(found, Unknown)
    assert str(MOST_ALTERNATIVES) in found.reason


@given(st.lists(st.one_of(TEXTS, NUMBERS), min_size=1, max_size=5))
def test_concatenation_of_known_values_is_known(values: list[Value]) -> None:
    """Texts and numbers make a text without a hole, with the least certain resolution of its parts."""
    joined = concatenate(*values)
    assert isinstance(joined, Text)
    pieces = [v.written if isinstance(v, Number) else v.shown for v in values if isinstance(v, Text | Number)]
    assert joined.exact == "".join(pieces)
    constant = any(isinstance(value, Text) and value.resolution is Resolution.CONSTANT for value in values)
    assert joined.resolution is (Resolution.CONSTANT if constant else Resolution.LITERAL)


@given(st.lists(st.one_of(TEXTS, UNKNOWN, PARAMETERS), min_size=1, max_size=5))
def test_concatenation_keeps_known_parts(values: list[Value]) -> None:
    """An unknown part is a hole between the known ones, and the text is never complete."""
    joined = concatenate(*values)
    assert isinstance(joined, Text)
    holes = [value for value in values if not isinstance(value, Text) or value.exact is None]
    kept = "".join(part for part in joined.parts if isinstance(part, str))
    assert kept == "".join(value.exact or "" for value in values if isinstance(value, Text))
    assert (joined.exact is None) is bool(holes)
    assert (joined.resolution is Resolution.PARTIAL) is bool(holes)
    assert (joined.reason is not None) is bool(holes)


@given(st.lists(TEXTS, min_size=1, max_size=2), st.lists(TEXTS, min_size=1, max_size=2))
def test_concatenation_of_alternatives_has_all_of_them(left: list[Value], right: list[Value]) -> None:
    """Each alternative of one part is combined with each of the other."""
    found = {text.shown for text in alternatives(concatenate(join(*left), join(*right))) if isinstance(text, Text)}
    assert found == {f"{a.shown}{b.shown}" for a in left for b in right if isinstance(a, Text) and isinstance(b, Text)}


def test_neighbouring_holes_are_one() -> None:
    """Two adjacent unknown parts are one hole of the name."""
    joined = concatenate(Text.of("a/"), Unknown("x"), Unknown("y"), Text.of("/b"))
    assert isinstance(joined, Text)
    assert (joined.shown, joined.parts) == ("a/{}/b", ("a/", Hole(), "/b"))


@given(PLAIN)
def test_a_value_read_back_is_no_literal(value: Value) -> None:
    """A text read from a variable is a constant; nothing else changes."""
    found = read_back(value)
    assert read_back(found) == found
    if isinstance(value, Text) and isinstance(found, Text):
        assert (found.parts, found.parameter, found.reason) == (value.parts, value.parameter, value.reason)
        assert found.resolution is (Resolution.CONSTANT if value.exact is not None else Resolution.PARTIAL)
    else:
        assert found == value


@given(st.lists(TEXTS, min_size=1, max_size=3))
def test_reading_back_reaches_into_lists_and_alternatives(values: list[Value]) -> None:
    """The elements of a list, and the alternatives of a value, are read back with it."""
    wanted = tuple(read_back(value) for value in values)
    assert read_back(Sequence(tuple(values))) == Sequence(wanted)
    assert read_back(Either(tuple(values))) == Either(wanted)


def test_only_a_parameter_alone_is_a_whole_one() -> None:
    """A text that is more than a parameter is not the value of the parameter."""
    parameter = Text.hole("it is a parameter", parameter="~/topic")
    assert whole_parameter(parameter)
    assert not whole_parameter(concatenate(Text.of("a/"), parameter))
    assert not whole_parameter(Text.of("a", Resolution.PARAMETER_DEFAULT, "~/topic"))


def test_a_number_that_may_be_unknown_is_unknown() -> None:
    """Both sides of a branch on it may run; of other values the known ones remain."""
    assert join(number(1), Unknown("it is read")) == Unknown("it is read")
    assert join(Text.of("a"), Unknown("it is read")) == Text.of("a")


def test_values_that_are_unknown_for_different_reasons_are_one() -> None:
    """What is null, or a parameter, stays beside them: conditions depend on it."""
    read, received = Unknown("it is read"), Unknown("it is received")
    null, rate = Unknown("it is null"), Unknown("it is a parameter", "rate")
    assert abstract.join(read, received) == read
    several = abstract.options((null, read, received), "choice")
    assert isinstance(several, Either)
    assert several.items == (null, read, read)  # the ways stay: what else was chosen with each
    assert abstract.join(read, rate, received) == rate


def test_lists_that_grew_under_conditions_are_one_list() -> None:
    """More than a few lists of different lengths become one with all elements, each of them optional."""
    a, b, c = (Text.of(name) for name in "abc")
    lists = [Sequence(items) for items in ((), (a,), (b,), (a, b), (a, b, c))]
    assert join(*lists) == Sequence((a, b, c), repeated=True)
    assert join(*lists[:3]) == Either(tuple(lists[:3]))


def test_rows_stay_apart() -> None:
    """Lists of one length, such as pairs, are alternatives, however many there are."""
    pairs = [Sequence((number(index), number(index + 1))) for index in range(MOST_ALTERNATIVES)]
    assert join(*pairs) == Either(tuple(pairs))
