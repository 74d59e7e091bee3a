from __future__ import annotations

from typing import Any

import pytest

from kg.assistants.compact import compact, place

PLACE: dict[str, Any] = {
    "repository": "github.com/a/b",
    "commit": None,
    "path": "src/x.cpp",
    "line": 7,
    "file": None,
    "vscode": None,
    "web": None,
}


@pytest.mark.parametrize(
    ("known", "text"),
    [
        ({"file": "/ws/src/x.cpp", "web": "https://a/x"}, "/ws/src/x.cpp:7"),
        ({"web": "https://a/x#L7"}, "https://a/x#L7"),
        ({}, "github.com/a/b src/x.cpp:7"),
        ({"line": None}, "github.com/a/b src/x.cpp"),
        ({"repository": None}, "src/x.cpp:7"),
    ],
)
def test_a_place_is_one_text(known: dict[str, Any], text: str) -> None:
    """A place is told by what opens it best: the file here, the page of the commit, the path in its source."""
    assert place({**PLACE, **known}) == text


def test_nothing_is_said_twice() -> None:
    """What the place of a fact says is not said beside it, nor in other words; a finding keeps the place to mend."""
    end = {"role": "publishes", "resolution": "literal", "title": "publishes", "file": "src/x.cpp", "line": 7}
    assert compact({**end, "evidence": PLACE}) == {
        "role": "publishes",
        "resolution": "literal",
        "evidence": "github.com/a/b src/x.cpp:7",
    }
    finding = {"file": "a.launch", "line": 3, "evidence": [PLACE]}
    assert compact(finding) == {**finding, "evidence": ["github.com/a/b src/x.cpp:7"]}


def test_what_is_empty_goes_and_what_is_false_stays() -> None:
    """Members that are null or empty are left out at any depth; false and zero say something."""
    long = {"a": None, "b": [], "c": {"d": ""}, "e": False, "f": 0, "g": [{"h": None, "where": PLACE}]}
    assert compact(long) == {"e": False, "f": 0, "g": [{"where": "github.com/a/b src/x.cpp:7"}]}
