from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from kg.extract.manifests.cmake_conditions import Token, decide
from kg.extract.manifests.cmake_scope import Scope


def scope() -> Scope:
    """Return the variables on, off, one, list (certain) and maybe (uncertain)."""
    known = Scope({"on": "ON", "off": "OFF", "one": "1", "list": "a;b", "name": "demo"}, set())
    known.set("maybe", "ON", certain=False)
    return known


def verdict(text: str) -> bool | None:
    """Evaluate a condition written with spaces between tokens; `'x'` is a quoted one."""
    words = text.split()
    return decide([Token(word.strip("'"), quoted=word.startswith("'")) for word in words], scope())


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("ON", True), ("0", False), ("7", True), ("X-NOTFOUND", False), ("FALSE", False),
        ("on", True), ("off", False), ("one", True), ("maybe", None), ("undefined", None),
        ("'name'", False), ("'on'", True),
        ("NOT on", False), ("NOT undefined", None), ("NOT NOT on", True),
        ("on AND off", False), ("undefined AND off", False), ("undefined AND on", None), ("on OR undefined", True),
        ("off OR undefined", None), ("off OR on AND on", True), ("( off OR on ) AND off", False),
        ("name STREQUAL demo", True), ("name STREQUAL 'other'", False), ("maybe STREQUAL ON", None),
        ("name MATCHES ^de", True), ("name MATCHES (a+)+", None), ("name MATCHES [", None),
        ("a IN_LIST list", True), ("c IN_LIST list", False), ("a IN_LIST undefined", None),
        ("one EQUAL 1", True), ("2 LESS 10", True), ("b LESS 1", None), ("3 GREATER_EQUAL 3", True),
        ("3.10 VERSION_GREATER 3.9", True), ("3.5 VERSION_LESS 3.5.0", False), ("x VERSION_LESS 1", None),
        ("2.8 VERSION_GREATER_EQUAL 2.8", True),
        ("DEFINED one", True), ("DEFINED undefined", None), ("EXISTS /tmp", None), ("POLICY CMP0001", True),
        ("COMMAND ament_add_gtest", None), ("AND", None), ("( on", True), ("on on", None), ("one EQUAL", None),
    ],
)  # fmt: skip
def test_conditions(text: str, expected: bool | None) -> None:  # noqa: FBT001  (a case)
    """A condition with certain variables is decided, any other is open."""
    assert verdict(text) is expected


def test_no_condition_is_open() -> None:
    """An empty or excessively nested condition is open."""
    assert decide([], scope()) is None
    assert decide([Token("(")] * 5000, scope()) is None


WORDS = [
    "on",
    "off",
    "maybe",
    "NOT",
    "AND",
    "OR",
    "(",
    ")",
    "EQUAL",
    "MATCHES",
    "DEFINED",
    "IN_LIST",
    "VERSION_LESS",
    "1",
    "²",
]


@given(st.lists(st.sampled_from(WORDS), max_size=12))
def test_any_tokens(words: list[str]) -> None:
    """Any sequence of tokens gives one of three answers."""
    assert decide([Token(word) for word in words], scope()) in {True, False, None}
