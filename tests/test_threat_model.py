"""The threat model is true: a test proves each guarantee."""

from __future__ import annotations

import ast
import re
from functools import cache

import pytest
from repository import ROOT

TEXT = (ROOT / "THREAT_MODEL.md").read_text(encoding="utf-8")
PROMISES = [
    line for line in TEXT.partition("## Promises")[2].partition("\n## ")[0].splitlines() if line.startswith("| ")
][1:]
NAMED = re.compile(r"`(tests/[\w/]+\.py)::(\w+)`")


@cache
def names_in(path: str) -> set[str]:
    """Return the names of the tests of a file."""
    tree = ast.parse((ROOT / path).read_text(encoding="utf-8"))
    return {node.name for node in ast.walk(tree) if isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef)}


@pytest.mark.parametrize("promise", PROMISES, ids=[line.split("|")[1].strip()[:60] for line in PROMISES])
def test_every_promise_names_tests_that_exist(promise: str) -> None:
    """Each line of the table names at least one test, and every named test exists."""
    named = NAMED.findall(promise)
    assert named
    assert not [f"{path}::{name}" for path, name in named if name not in names_in(path)]


def test_every_promise_of_the_endpoint_is_there() -> None:
    """The guarantees C1 to C40 of the server are all in the table."""
    found = set()
    for first, last in re.findall(r"\bC(\d+)(?: to C(\d+))?", "\n".join(PROMISES)):
        found |= set(range(int(first), int(last or first) + 1))
    assert found == set(range(1, 42))
