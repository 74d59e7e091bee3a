from __future__ import annotations

import msgspec
import pytest
from search.store import CONTENT

from kg.search.index import build
from kg.search.marking import MARKED_DOWN
from kg.search.ranking import prior
from kg.search.reading import Content
from kg.search.words import stem

PLAIN = next(node for node in CONTENT.nodes if node.texts and node.kind == "executable")
PACKAGE = CONTENT.packages[PLAIN.package]


def worth(*asked: str, deprecated: bool = False, **changes: object) -> float:
    """Return the prior of the node that is told most of, after changes."""
    package = msgspec.structs.replace(PACKAGE, deprecated=deprecated)
    node = msgspec.structs.replace(PLAIN, package=0, **changes)
    return float(prior(build(Content([package], [node])), frozenset(asked))[0])


@pytest.mark.parametrize(
    ("changes", "expected"),
    [
        ({}, 1.0),
        ({"name": "test_merger"}, 0.7),
        ({"path": "examples/merger.cpp"}, 0.8),
        ({"path": "tests/tutorials/merger.cpp"}, 0.7 * 0.7),
        ({"path": "src/test.cpp"}, 1.0),
        ({"kind": "class"}, 0.8),
        ({"texts": ()}, 0.9),
        ({"deprecated": True}, 0.9),
    ],
)
def test_what_is_rarely_meant_is_worth_less(changes: dict[str, object], expected: float) -> None:
    """Tests and examples by their names and folders, classes of libraries, what nobody describes or maintains."""
    assert worth(**changes) == pytest.approx(expected)  # type: ignore[arg-type]  # one of them is a switch


@pytest.mark.parametrize(
    "word", ["tests", "examples", "demo", "samples", "tutorials", "mock", "simulated", "simulator"]
)
def test_words_that_mark_down_are_compared_as_stems(word: str) -> None:
    """Whatever the form of the word in a name or a folder."""
    assert stem(word) in MARKED_DOWN
    assert all(stem(one) == one for one in MARKED_DOWN)


def test_what_was_asked_for_is_not_marked_down() -> None:
    """Who asks for a test means one; other marks stay."""
    assert worth("test", name="test_merger") == 1.0
    assert worth("test", path="tests/tutorials/merger.cpp") == pytest.approx(0.7)
    assert worth("merger", name="test_merger") == pytest.approx(0.7)
