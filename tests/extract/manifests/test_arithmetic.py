from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from kg.extract.manifests.cmake_builtins import compute


@pytest.mark.parametrize(
    ("expression", "value"),
    [
        ("1 + 2 * 3", 7),
        ("(1 + 2) * 3", 9),
        ("7 % 4 - -1", 4),
        ("7 / 2", 3),
        ("1 / 0", None),
        ("x + 1", None),
        ("", None),
        ("(" * 300, None),
        ("999999999999 * 999999999999", None),
    ],
)
def test_expressions(expression: str, value: int | None) -> None:
    """Whole numbers are computed; names and errors are not."""
    assert compute(expression) == value


@given(st.text(alphabet="0123456789+-*/%() x", max_size=40))
def test_any_text(expression: str) -> None:
    """Any text gives a number or nothing."""
    assert isinstance(compute(expression), int | None)
