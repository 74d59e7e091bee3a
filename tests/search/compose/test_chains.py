from __future__ import annotations

from itertools import islice, pairwise, permutations
from typing import TYPE_CHECKING

from hypothesis import given, settings
from hypothesis import strategies as st

from kg.search.compose import chains
from kg.search.compose.chains import Search, Step

if TYPE_CHECKING:
    from collections.abc import Sequence

    import pytest

TYPES = "abcde"


@st.composite
def networks(draw: st.DrawFn) -> list[Step]:
    """Return the steps of a small network of random nodes, each with some steps."""
    steps = []
    for part in range(draw(st.integers(1, 6))):
        ways = draw(st.lists(st.tuples(st.sampled_from(TYPES), st.sampled_from(TYPES)), max_size=4, unique=True))
        family, marks = draw(st.integers(0, part)), draw(st.integers(0, 3))
        kept = draw(st.booleans())
        cost = draw(st.integers(1, 4))
        steps += [
            Step(part, family, source, target, cost, f"{part}{target}", marks, required=kept) for source, target in ways
        ]
    return steps


def between(one: Step, other: Step) -> int:
    """Return a cost that depends on both steps."""
    return (one.part * 7 + other.part * 3) % 4


def is_chain(
    steps: Sequence[Step], starts: Sequence[str], goals: str, wanted: int, given_marks: dict[str, int]
) -> bool:
    """Return whether steps are a chain by definition: linked, of different nodes, without detours, and complete."""
    if steps[0].source not in starts or len({step.family for step in steps}) < len(steps):
        return False
    if any(one.target != other.source for one, other in pairwise(steps)):
        return False
    marks, had = given_marks.get(steps[0].source, 0) & wanted, {*starts, steps[0].source}
    for step in steps[:-1]:
        marks |= step.marks
        if step.target in goals and marks & wanted == wanted:
            return False  # it was complete before
        if step.target in had and not (step.required and step.source == step.target):
            return False
        had.add(step.target)
    last = steps[-1]
    return last.target in goals and (marks | last.marks) & wanted == wanted


def by_force(
    steps: Sequence[Step], asked: tuple[Sequence[str], str, int, dict[str, int]], length: int
) -> dict[tuple[int, ...], int]:
    """Return the least cost of each sequence of nodes, for all possible sequences."""
    found: dict[tuple[int, ...], int] = {}
    for number in range(1, length + 1):
        for chosen in permutations(steps, number):
            if is_chain(chosen, *asked):
                families = tuple(step.family for step in chosen)
                cost = sum(step.cost for step in chosen)
                cost += sum(between(one, other) for one, other in pairwise(chosen))
                found[families] = min(cost, found.get(families, cost))
    return found


@given(
    networks(),
    st.lists(st.sampled_from(TYPES), min_size=1, max_size=2, unique=True),
    st.sets(st.sampled_from(TYPES), min_size=1, max_size=2),
    st.integers(1, 3),
    st.tuples(st.sampled_from([0, 1, 3]), st.dictionaries(st.sampled_from(TYPES), st.integers(0, 3))),
)
@settings(max_examples=100, deadline=None)
def test_the_chains_are_those_of_trying_everything(
    steps: list[Step], starts: list[str], goals: set[str], length: int, bits: tuple[int, dict[str, int]]
) -> None:
    """The search yields each sequence of nodes that is a chain, once, with its least cost, in the order of costs."""
    by_type = {name: [step for step in steps if step.source == name] for name in TYPES}
    search = Search(by_type, starts, frozenset(goals), length, between, *bits)
    found = list(search.best())
    expected = by_force(steps, (starts, "".join(goals), *bits), length)
    assert {tuple(step.family for step in chain.steps): chain.cost for chain in found} == expected
    assert len(found) == len(expected)
    assert [(chain.cost, chain.keys) for chain in found] == sorted((chain.cost, chain.keys) for chain in found)


@given(networks(), st.randoms())
@settings(max_examples=50, deadline=None)
def test_the_order_of_what_is_read_changes_nothing(steps: list[Step], random: object) -> None:
    """The same network gives the same chains in the same order, whatever the order of its steps."""
    mixed = list(steps)
    random.shuffle(mixed)  # type: ignore[attr-defined]  # a random.Random, which hypothesis gives as an object
    answers = [
        [
            (chain.cost, tuple(step.key for step in chain.steps))
            for chain in islice(
                Search(
                    {name: [step for step in order if step.source == name] for name in TYPES}, ["a"], frozenset("e"), 3
                ).best(),
                5,
            )
        ]
        for order in (steps, mixed)
    ]
    assert answers[0] == answers[1]


def test_a_search_that_looks_at_too_much_says_so(monkeypatch: pytest.MonkeyPatch) -> None:
    """At the limit of visited steps, the search ends with its complete chains and records the cut."""
    monkeypatch.setattr(chains, "_MOST_LOOKS", 20)
    steps = {
        name: [Step(10 * at + way, 10 * at + way, name, after, 1, f"{name}{way}") for way in range(10)]
        for at, (name, after) in enumerate(zip("abcdef", "bcdefg", strict=True))
    }
    search = Search(steps, ["a"], frozenset("g"), 6)
    assert sum(1 for _ in search.best()) > 0
    assert search.cut_off


def test_equal_chains_are_found_without_looking_at_all_of_them() -> None:
    """Among a million chains of the same cost, the first ones are found at once, by their keys."""
    steps = {
        name: [Step(10 * at + way, 10 * at + way, name, after, 1, f"{name}{way}") for way in range(10)]
        for at, (name, after) in enumerate(zip("abcdef", "bcdefg", strict=True))
    }
    search = Search(steps, ["a"], frozenset("g"), 6)
    assert [chain.keys[-1] for chain in islice(search.best(), 3)] == ["f0", "f1", "f2"]
    assert search.visited < 20
