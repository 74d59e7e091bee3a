from __future__ import annotations

from hypothesis import given
from hypothesis import strategies as st

from kg.rules.authoring.examples import Fence, Heading, parts


def test_headings_and_blocks_have_their_lines() -> None:
    """Headings of all levels and fenced blocks are found; lines count from one, a block has the line of its fence."""
    found = list(parts("# A\n\nprose\n## B ##\n```turtle given\n:a :b :c .\n```\n"))
    assert found == [
        Heading(1, "A", 1),
        Heading(2, "B", 4),
        Fence("turtle given", ":a :b :c .\n", 5, closed=True),
    ]


def test_a_block_ends_at_a_fence_of_its_own_kind() -> None:
    """A longer fence, or one of tildes, contains shorter ones; headings in blocks are text."""
    found = list(parts("~~~~ text why\n```\n## no heading\n~~~\n~~~~~\n## B\n"))
    assert found == [Fence("text why", "```\n## no heading\n~~~\n", 1, closed=True), Heading(2, "B", 6)]


def test_a_block_that_is_not_closed_says_so() -> None:
    """An unclosed block is marked, and contains the rest of the page."""
    assert list(parts("```x\na\nb")) == [Fence("x", "a\nb\n", 1, closed=False)]


@given(st.text(alphabet="#`~ ab\n", max_size=80))
def test_any_text_has_parts(text: str) -> None:
    """Any text is accepted, and parts are in the order of their lines."""
    lines = [part.line for part in parts(text)]
    assert lines == sorted(set(lines))
