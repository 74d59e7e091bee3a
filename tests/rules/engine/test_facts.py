from __future__ import annotations

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.stateful import RuleBasedStateMachine, invariant, rule

from kg.rules.engine.facts import Facts, distinct, merged, unpack

PAIRS = st.lists(st.tuples(st.integers(1, 9), st.integers(1, 9)), max_size=8)


def keys(pairs: list[tuple[int, int]]) -> np.ndarray[tuple[int], np.dtype[np.int64]]:
    """Return pairs as sorted keys."""
    return distinct(np.array([subject << 32 | value for subject, value in pairs], np.int64))


class AgainstASet(RuleBasedStateMachine):
    """A set of columns, changed and read in any order, equals a set of pairs."""

    def __init__(self) -> None:
        super().__init__()
        self.facts = Facts()
        self.pairs: set[tuple[int, int]] = set()

    @rule(pairs=PAIRS)
    def add(self, pairs: list[tuple[int, int]]) -> None:
        """Adding returns the new ones."""
        new = self.facts.add(5, keys(pairs))
        assert new.size == len(set(pairs) - self.pairs)
        self.pairs |= set(pairs)

    @rule(pairs=PAIRS)
    def remove(self, pairs: list[tuple[int, int]]) -> None:
        """Removing returns those that were present."""
        gone = self.facts.remove(5, keys(pairs))
        assert gone.size == len(set(pairs) & self.pairs)
        self.pairs -= set(pairs)

    @rule()
    def read(self) -> None:
        """Both orders have the same pairs, and the start of each term is known."""
        subjects, objects = unpack(self.facts.keys(5))
        assert set(zip(subjects.tolist(), objects.tolist(), strict=True)) == self.pairs
        objects, subjects = unpack(self.facts.by_object(5))
        assert sorted(zip(subjects.tolist(), objects.tolist(), strict=True)) == sorted(self.pairs)
        starts = self.facts.starts(5, 12, by_object=True)
        assert [int(starts[term + 1] - starts[term]) for term in range(10)] == np.bincount(
            objects, minlength=10
        ).tolist()

    @rule(subject=st.integers(1, 9), value=st.integers(1, 9))
    def ask(self, subject: int, value: int) -> None:
        """A predicate has a subject and an object, not necessarily in one triple, and another predicate has neither."""
        subjects, values = {one for one, _ in self.pairs}, {one for _, one in self.pairs}
        assert self.facts.has(5, subject) == (subject in subjects)
        assert self.facts.has(5, None, value) == (value in values)
        assert self.facts.has(5, subject, value) == (subject in subjects and value in values)
        assert not self.facts.has(6, subject, value)

    @rule(pairs=PAIRS)
    def copy(self, pairs: list[tuple[int, int]]) -> None:
        """A copy is independent."""
        other = self.facts.copy()
        other.add(5, keys(pairs))
        assert len(other) == len(self.pairs | set(pairs))

    @invariant()
    def size(self) -> None:
        """The number of triples and the predicates are known without reading."""
        assert len(self.facts) == len(self.pairs)
        assert (5 in self.facts.predicates) == bool(self.pairs)


AgainstASet.TestCase.settings = settings(max_examples=30, stateful_step_count=20, deadline=None)
TestAgainstASet = AgainstASet.TestCase


@given(st.sets(st.integers(0, 300)), st.sets(st.integers(0, 300)))
def test_merging_gives_all_in_order(one: set[int], other: set[int]) -> None:
    """Two disjoint sorted arrays become one, however small the second is."""
    left, right = sorted(one - other), sorted(other)
    assert merged(np.array(left, np.int64), np.array(right, np.int64)).tolist() == sorted(one | other)
