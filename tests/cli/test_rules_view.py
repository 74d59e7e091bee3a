"""Layout of texts about rules."""

from __future__ import annotations

from kg.cli.commands.rules import list_columns, paragraphs


def test_paragraphs_are_joined_and_lists_are_not() -> None:
    """The lines of a paragraph or an item are joined; indented text is unchanged."""
    text = "One\nparagraph.\n\nAnother:\n\n* an item\n  goes on\n* the next\n\n    code  here\n    more"
    assert list(paragraphs(text)) == [
        "One paragraph.",
        "",
        "Another:",
        "",
        "* an item goes on",
        "* the next",
        "",
        "    code  here",
        "    more",
    ]


def test_a_state_is_never_left_out() -> None:
    """The column of states is omitted only if no rule has one."""
    assert list_columns([("f/a", "", "rq", None, "")])[-1].spare
    assert not list_columns([("f/a", "", "rq", None, ""), ("f/b", "", "rq", None, "error")])[-1].spare
