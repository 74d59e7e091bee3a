from __future__ import annotations

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from kg.evaluate.tables import Z95, bootstrap, wilson

SHARES = st.integers(1, 5000).flatmap(lambda number: st.tuples(st.integers(0, number), st.just(number)))


@given(SHARES)
def test_the_ends_of_an_interval_are_where_the_score_test_just_accepts(counted: tuple[int, int]) -> None:
    """Wilson's interval inverts the score test: at an end, the share is z standard errors away."""
    right, number = counted
    for end in wilson(right, number):
        if 0 < end < 1:
            error = math.sqrt(end * (1 - end) / number)
            assert math.isclose(abs(right / number - end), Z95 * error, rel_tol=1e-6, abs_tol=1e-9)


@given(SHARES)
def test_an_interval_holds_the_share_and_mirrors(counted: tuple[int, int]) -> None:
    """The share lies inside, and the interval of the complement is the mirror image."""
    right, number = counted
    low, high = wilson(right, number)
    assert 0 <= low <= right / number <= high <= 1
    other = wilson(number - right, number)
    assert math.isclose(other[0], 1 - high, abs_tol=1e-12)
    assert math.isclose(other[1], 1 - low, abs_tol=1e-12)


@pytest.mark.parametrize(
    ("right", "number", "low", "high"),
    [(0, 0, 0.0, 1.0), (0, 10, 0.0, 0.277532), (10, 10, 0.722467, 1.0), (81, 263, 0.255265, 0.366239)],
)
def test_known_intervals(right: int, number: int, low: float, high: float) -> None:
    """81 of 263 is the example of Newcombe (1998), table I; without data the interval is 0 to 1."""
    assert wilson(right, number) == pytest.approx((low, high), abs=2e-4)


@given(st.lists(st.floats(0, 1), min_size=1, max_size=30), st.integers(0, 5))
def test_a_bootstrap_lies_within_the_values_and_repeats(values: list[float], seed: int) -> None:
    """The interval of a mean lies between the least and the largest value, the same for the same seed."""
    low, high = bootstrap(values, rounds=50, seed=seed)
    assert min(values) - 1e-9 <= low <= high <= max(values) + 1e-9
    assert bootstrap(values, rounds=50, seed=seed) == (low, high)


def test_a_bootstrap_of_nothing() -> None:
    """Without values there is no mean."""
    assert bootstrap([]) == (0.0, 0.0)
