"""Division of a response's lines into pages, and the spelling of places."""

from __future__ import annotations

from typing import Any

from hypothesis import given
from hypothesis import strategies as st

from kg.assistants.lines import Where, paged

LINES = st.lists(st.text(st.characters(codec="utf-8", exclude_characters="\n\r"), min_size=1, max_size=80), max_size=60)


def place(**given_: Any) -> dict[str, Any]:
    """Return a place in the form of views."""
    return {
        "repository": "local/ws",
        "path": "src/a.cpp",
        "line": 7,
        "file": None,
        "commit": None,
        "web": None,
    } | given_


@given(LINES)
def test_pages_have_every_line_once_and_keep_their_size(lines: list[str]) -> None:
    """In order, the pages give the lines in their order, each within the size limit."""
    read: list[str] = []
    for page in range(1, 500):
        text = paged(lines, ["legend"], page, 600)
        assert len(text.encode()) <= 600
        *shown, last = text.split("\n")
        assert last == "legend"
        if shown and shown[-1].startswith(f"page {page} of "):
            read += shown[:-1]
            if shown[-1].endswith(f" of {page}"):
                break
        else:
            read += shown
            break
    assert read == lines


def test_a_line_longer_than_a_page_is_cut() -> None:
    """The page does not exceed its size."""
    text = paged(["x" * 5000], [], 1, 600)
    assert text.endswith(" ...")
    assert len(text) <= 600


def test_a_page_that_does_not_exist_is_named() -> None:
    """The response has the number of pages."""
    assert paged(["a"], [], 3, 600) == "page 3 does not exist; the answer has 1"


def test_paths_are_within_the_first_source() -> None:
    """The legend has the source's location; places of other sources have its name, and rules of kg none."""
    where = Where()
    assert where(place(file="/ws/src/a.cpp")) == "src/a.cpp:7"
    assert where(place(repository="github.com/x/y", line=None)) == "github.com/x/y src/a.cpp"
    assert where(place(repository=None, path="rules/a.rq")) == "rules/a.rq:7"
    assert where(None) == ""
    assert where.legend == ["paths are below /ws/"]


def test_a_source_that_is_not_here_is_named_by_its_commit() -> None:
    """The web page of a line can be derived from both."""
    where = Where()
    where(place(repository="github.com/x/y", commit="0123456789abcdef"))
    assert where.legend == ["paths are of github.com/x/y at commit 0123456789ab"]
