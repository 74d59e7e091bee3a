"""How texts about rules are laid out."""

from __future__ import annotations

from kg.cli.rules_view import list_columns, paragraphs


def test_paragraphs_are_joined_and_lists_are_not() -> None:
    """Lines of a paragraph or of an item become one, what is indented by itself stays as it is."""
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
    """The column of states may be spared only where no rule has one."""
    assert list_columns([("f/a", "", "rq", None, "")])[-1].spare
    assert not list_columns([("f/a", "", "rq", None, ""), ("f/b", "", "rq", None, "error")])[-1].spare
