"""Tests of figures of a column, against numpy."""

from __future__ import annotations

import numpy as np
from hypothesis import given
from hypothesis import strategies as st
from pytest import approx  # noqa: PT013 - the only name used

from kg.corpus.selection.select import figures

NUMBERS = st.lists(st.integers(0, 10**6), min_size=2, max_size=60)


@given(NUMBERS)
def test_figures_are_those_of_numpy(values: list[int]) -> None:
    """Each figure equals that of numpy, with the deviation of a sample."""
    found = figures(values)
    assert (found["min"], found["max"]) == (min(values), max(values))
    assert found["median"] == approx(float(np.median(values)))
    assert found["mean"] == approx(float(np.mean(values)))
    assert found["sd"] == approx(float(np.std(values, ddof=1)), abs=1e-6)
    if found["mean"]:
        assert found["cv"] == approx(found["sd"] / found["mean"])
    else:
        assert "cv" not in found


def test_figures_of_little() -> None:
    """Without numbers there is no figure, with one number no deviation."""
    assert figures([]) == {}
    assert figures([5]) == {"min": 5, "max": 5, "median": 5, "mean": 5}
