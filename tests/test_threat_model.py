"""The threat model is true: a test proves each guarantee."""

from __future__ import annotations

import ast
import re
from functools import cache
from typing import TYPE_CHECKING, Final, TypeAlias

import pytest
from repository import ROOT, Routine

if TYPE_CHECKING:
    from collections.abc import Iterator

TEXT = (ROOT / "THREAT_MODEL.md").read_text(encoding="utf-8")
PROMISES = [
    line for line in TEXT.partition("## Promises")[2].partition("\n## ")[0].splitlines() if line.startswith("| ")
][1:]
NAMED = re.compile(r"`(tests/[\w/]+\.py)::(\w+)`")
EVERY_PROMISE = pytest.mark.parametrize("promise", PROMISES, ids=[line.split("|")[1].strip()[:60] for line in PROMISES])
NOT_RUN: Final = {"pytest.mark.skip", "pytest.mark.xfail"}
Routines: TypeAlias = dict[str, Routine]


@cache
def routines(path: str) -> Routines:
    """Return the functions and methods of a file by name."""
    return routines_of((ROOT / path).read_text(encoding="utf-8"))


def routines_of(text: str) -> Routines:
    """Return the functions and methods of a source text by name."""
    found = ast.walk(ast.parse(text))
    return {node.name: node for node in found if isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef)}


@cache
def helpers() -> Routines:
    """Return the functions of all files that tests share, by name."""
    shared = (path.relative_to(ROOT) for path in (ROOT / "tests").rglob("*.py") if not path.name.startswith("test_"))
    return {name: one for path in shared if "cases" not in path.parts for name, one in routines(str(path)).items()}


def asserts(routine: Routine, known: Routines, seen: frozenset[str] = frozenset()) -> bool:
    """Whether a function compares something with what is expected, itself or in a function of the tests it calls."""
    own = (node for node in ast.walk(routine) if isinstance(node, ast.Assert))
    if any(not isinstance(node.test, ast.Constant) for node in own):
        return True
    called = set(calls(routine))
    if called & {"pytest.raises", "pytest.fail"}:
        return True
    names = {name.rpartition(".")[2] for name in called} & known.keys() - seen - {routine.name}
    return any(asserts(known[name], known, seen | names) for name in names)


def calls(routine: Routine) -> Iterator[str]:
    """Yield the dotted names of the functions that a function calls or passes on."""
    for node in ast.walk(routine):
        if isinstance(node, ast.Name | ast.Attribute):
            yield ast.unparse(node)


def troubles(routine: Routine, known: Routines) -> Iterator[str]:
    """Yield the reasons why a test proves nothing."""
    marks = {ast.unparse(one.func if isinstance(one, ast.Call) else one) for one in routine.decorator_list}
    if marks & NOT_RUN:
        yield "is skipped or expected to fail"
    if not asserts(routine, known):
        yield "asserts nothing"


@EVERY_PROMISE
def test_every_promise_names_tests_that_exist(promise: str) -> None:
    """Each line of the table names at least one test, and every named test exists."""
    named = NAMED.findall(promise)
    assert named
    assert not [f"{path}::{name}" for path, name in named if name not in routines(path)]


@EVERY_PROMISE
def test_every_test_of_a_promise_asserts_something(promise: str) -> None:
    """Every named test runs, and compares something with what is expected."""
    found = [
        f"{path}::{name} {trouble}"
        for path, name in NAMED.findall(promise)
        for trouble in troubles(routines(path)[name], {**helpers(), **routines(path)})
    ]
    assert not found


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("def test_it():\n    assert found() == 1", []),
        ("def test_it():\n    with pytest.raises(ValueError):\n        found()", []),
        ("def check(one):\n    assert one\ndef test_it():\n    check(found())", []),
        ("def test_it():\n    found()", ["asserts nothing"]),
        ("def test_it():\n    assert True", ["asserts nothing"]),
        ("def check(one):\n    check(one)\ndef test_it():\n    check(found())", ["asserts nothing"]),
        ("@pytest.mark.skip(reason='slow')\ndef test_it():\n    assert found()", ["is skipped or expected to fail"]),
    ],
)
def test_tests_that_prove_nothing_are_recognised(text: str, expected: list[str]) -> None:
    """A test without an assertion of its own or of a helper proves nothing, nor does one that is skipped."""
    known = routines_of(text)
    assert list(troubles(known["test_it"], known)) == expected


def test_every_promise_of_the_endpoint_is_there() -> None:
    """The guarantees C1 to C41 of the server are all in the table."""
    found = set()
    for first, last in re.findall(r"\bC(\d+)(?: to C(\d+))?", "\n".join(PROMISES)):
        found |= set(range(int(first), int(last or first) + 1))
    assert found == set(range(1, 42))
