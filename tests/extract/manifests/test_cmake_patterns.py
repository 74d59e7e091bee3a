from __future__ import annotations

import time

import pytest

from kg.extract.manifests.cmake_scope import keep_matching, matches, replace_all


@pytest.mark.parametrize(
    ("pattern", "text", "expected"),
    [
        ("^a.*b$", "a--b", True),
        ("x", "abc", False),
        ("a{2}", "aa", False),
        ("a{2}", "a{2}", True),
        ("[", "a", None),
        ("(a+)+$", "a", None),
        ("a**", "a", None),
        ("x" * 300, "x", None),
        (".*.*.*=", "x" * 5000, None),
    ],
)
def test_matching(pattern: str, text: str, expected: bool | None) -> None:  # noqa: FBT001  (a case)
    """An expression runs only if it is valid and certain to end soon."""
    assert matches(pattern, text) is expected


@pytest.mark.parametrize(
    ("pattern", "replacement", "text", "expected"),
    [
        (r"^(.*)/(.*)[.]cpp$", r"\2_in_\1", "src/a.cpp", "a_in_src"),
        ("a", r"\1\9", "abc", "bc"),
        ("a|(b)", r"<\1>", "ab", "<><b>"),
        ("(a+)+", "", "aaa", "aaa"),
    ],
)
def test_replacing(pattern: str, replacement: str, text: str, expected: str) -> None:
    """Groups that did not match, or do not exist, are empty; an expression that is not run changes nothing."""
    assert replace_all(pattern, replacement, text) == expected


def test_filtering() -> None:
    """Items are filtered by whether they match, and all remain if that is unknown."""
    assert keep_matching("[.]h$", ["a.h", "b.c"], wanted=True) == ["a.h"]
    assert keep_matching("[.]h$", ["a.h", "b.c"], wanted=False) == ["b.c"]
    assert keep_matching("[", ["a.h"], wanted=False) == ["a.h"]


@pytest.mark.parametrize("pattern", ["a?" * 30 + "a" * 30, "(.*)(.*)(.*)(.*)!", "(a|a)*b", "[a-z]+[a-z]+[a-z]+[0-9]"])
@pytest.mark.parametrize("length", [10, 30, 300, 100_000])
def test_no_expression_runs_long(pattern: str, length: int) -> None:
    """Expressions known to backtrack exponentially are rejected, or fast on texts of any length."""
    start = time.process_time()
    matches(pattern, "a" * length)
    assert time.process_time() - start < 1
