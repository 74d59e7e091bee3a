"""Blocks of pages: headings, paragraphs, items and rows, at their lines, without the excluded parts."""

from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from kg.extract.texts.documents import markdown
from kg.extract.texts.pages import read_page


def shown(text: str, *, rst: bool = False) -> list[str]:
    """Return the blocks of a page as `line kind: text`."""
    return [f"{one.line} {one.kind}: {one.text}" for one in read_page(text, rst=rst)]


def test_markdown() -> None:
    """Both forms of headings, multi-line paragraphs, items and tables are blocks."""
    page = "Title\n=====\nOne\ntwo.\n\n## Next ##\n* item\n  goes on\n1. first\n\n| a | b |\n|---|---|\n| c | d |\n"
    assert shown(page) == [
        "1 heading: Title",
        "3 paragraph: One two.",
        "6 heading: Next",
        "7 item: item goes on",
        "9 item: first",
        "11 row: a\tb",
        "13 row: c\td",
    ]


def test_what_goes_on_with_an_item() -> None:
    """A paragraph indented below an item is distinguished from a separate one."""
    assert [one.kind for one in read_page("* a\n\n  more of a\n\n  still\n\nfree\n")] == [
        "item",
        "continued",
        "continued",
        "paragraph",
    ]


def test_what_is_no_text_of_a_page() -> None:
    """Code in fences or indented, comments, rules and definitions of links are excluded."""
    page = "<!-- not\nthis -->\n```\ncode\n```\n\n    indented\n\n---\n[a]: http://x\n~~~ sh\n```\n~~~\nText.\n"
    assert shown(page) == ["14 paragraph: Text."]


def test_restructured_text() -> None:
    """Levels of headings follow from the order of their signs; directives and literal blocks are excluded."""
    page = (
        "====\nTop\n====\n\nInner\n-----\n\n.. image:: x.png\n   :width: 3\n\nSay::\n\n  code\n\nAfter.\n\nNext\n====\n"
    )
    blocks = read_page(page, rst=True)
    assert [(one.text, one.level) for one in blocks if one.kind == "heading"] == [("Top", 1), ("Inner", 2), ("Next", 1)]
    assert [one.text for one in blocks if one.kind == "paragraph"] == ["Say:", "After."]


def test_doxygen() -> None:
    """Section commands become headings, code commands fences; the lines are preserved."""
    page = "/**\n * \\mainpage Tools\n * \\section a Nodes\n * @b one does it\n * @code\n * x\n"
    page += " * @endcode\n * @author X\n */"
    assert markdown(page).split("\n") == ["", "# Tools", "## Nodes", "@b one does it", "```", "x", "```", "", ""]


@given(st.text(alphabet="#-=*|`~.:[]>< \nab1\\", max_size=400), st.sampled_from(["md", "rst"]))
def test_any_page_is_read(text: str, ending: str) -> None:
    """Any page is read; its blocks are in the order of their lines and contain text."""
    blocks = read_page(text, rst=ending == "rst")
    lines = [one.line for one in blocks]
    assert lines == sorted(lines)
    assert all(1 <= line <= text.count("\n") + 1 for line in lines)


@pytest.mark.parametrize(
    "piece", ["> ", "* ", "- " * 50 + "\n", "#", "[", "| ", "<!--", "`", "\t", "  * x\n", "=\n", ".. x\n"]
)
def test_hostile_pages_end(piece: str) -> None:
    """Pages with endless nesting or repetition are read up to a limit."""
    text = piece * 60_000
    assert len(read_page(text)) + len(read_page(text, rst=True)) <= 20_000
