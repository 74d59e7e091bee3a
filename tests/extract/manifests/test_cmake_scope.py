from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from kg.extract.manifests.cmake_scope import LONGEST_VALUE, Scope, split_list, strip_generators


def scope(**variables: str) -> Scope:
    """Return a scope in which these variables are certain."""
    return Scope(dict(variables), set())


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("plain", ("plain", True)),
        ("${a}-${a}", ("one-one", True)),
        ("${${b}}", ("one", True)),
        ("x${none}y", ("xy", False)),
        ("$ENV{HOME}", ("/home", True)),
        ("$ENV{NONE}", ("", False)),
        (r"\${a}", ("${a}", True)),
        (r"a\"b\n", ('a"b\n', True)),
        ("${", ("${", True)),
        ("$<TARGET_FILE:a>", ("$<TARGET_FILE:a>", True)),
    ],
)
def test_expansion(text: str, expected: tuple[str, bool]) -> None:
    """References are replaced from the innermost outwards, escapes resolved; unknown variables make it uncertain."""
    assert scope(a="one", b="a", **{"ENV{HOME}": "/home"}).expand(text) == expected


def test_uncertain_variables() -> None:
    """An uncertain variable gives its value and marks it as uncertain."""
    known = scope()
    known.set("a", "x", certain=False)
    assert known.expand("${a}") == ("x", False)
    known.set("a", "y")
    assert known.expand("${a}") == ("y", True)


def test_values_cannot_explode() -> None:
    """A list that doubles itself repeatedly is bounded."""
    known = scope(a="x;y")
    for _ in range(100):
        known.set("a", known.expand("${a};${a}")[0])
    assert len(known.variables["a"]) <= LONGEST_VALUE


def test_self_reference_ends() -> None:
    """Expanding a value with a reference to itself terminates."""
    text, _ = scope(a="${a}x").expand("${a}")
    assert text.endswith("x")


def test_merging_branches() -> None:
    """A variable equal in all branches is certain; different lists are united, and uncertain."""
    outer = scope(same="1", kept="k", gone="g")
    one, two = outer.child(), outer.child()
    one.set("list", "a;b")
    two.set("list", "b;c")
    one.set("both", "x")
    two.set("both", "x")
    one.unset("gone")
    two.unset("gone")
    outer.merge([one, two])
    assert outer.variables == {"same": "1", "kept": "k", "list": "a;b;c", "both": "x"}
    assert outer.uncertain == {"list"}


@pytest.mark.parametrize(
    ("value", "expected"),
    [("", []), ("a", ["a"]), ("a;b;;c;", ["a", "b", "c"]), (r"a\;b;c", ["a;b", "c"])],
)
def test_lists(value: str, expected: list[str]) -> None:
    """Elements are separated by unescaped semicolons; empty ones are dropped."""
    assert split_list(value) == expected


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("src/a.cpp", "src/a.cpp"),
        ("$<BUILD_INTERFACE:src/a.cpp>", "src/a.cpp"),
        ("$<$<CONFIG:Debug>:a.cpp>", "a.cpp"),
        ("a$<SEMICOLON>b", "ab"),
        ("$<unclosed", "$<unclosed"),
    ],
)
def test_generator_expressions(text: str, expected: str) -> None:
    """Generator expressions become their possible text."""
    assert strip_generators(text) == expected


@given(st.text(alphabet="${}abENV<>:;\\x", max_size=60))
def test_any_text(text: str) -> None:
    """Any text can be expanded, whatever its braces."""
    known = scope(a="b", b="${a}", x="$<a:b>")
    assert isinstance(known.expand(text)[0], str)
    assert isinstance(strip_generators(text), str)
