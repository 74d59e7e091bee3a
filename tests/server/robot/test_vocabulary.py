"""Blocks and text use the same words."""

from __future__ import annotations

import re
from typing import Final

from repository import ROOT

from kg.robot.programs.tokens import BEGINNINGS, ENDINGS, FUNCTIONS, RESERVED

BLOCKS: Final = (ROOT / "kg/server/static/robot/blocks.js").read_text("utf-8")
WORDS: Final = {
    *BEGINNINGS,
    *ENDINGS,
    *FUNCTIONS,
    *RESERVED,
    "until",
    "each",
    "in",
    "from",
    "at",
    "the",
    "same",
    "time",
}
WORDS_OF_THE_START: Final = {"when", "the", "program", "starts"}
"""The words of the first block, which has no line in the text."""


def test_what_blocks_say_is_written_in_the_text_alike() -> None:
    """Each word on a block of the language is a word of the text."""
    rows = re.findall(r'\[\["(.*?)".*?\]\]', BLOCKS) + re.findall(r'\], \["([^"]*?%1[^"]*?)"', BLOCKS)
    said = {word for row in rows for word in re.findall(r"[a-z]+", row)}
    assert {"while", "forever", "during", "contains"} <= said
    assert said <= WORDS | WORDS_OF_THE_START | {"whenever", "soon", "as"}


def test_operators_of_blocks_are_those_of_the_text() -> None:
    """An option of a block is shown as its operator in the text."""
    for name, signs in (("COMPARED", "< <= = != >= >"), ("COUNTED", "+ - * /"), ("OF_ONE", "absolute - round count")):
        found = re.search(rf"const {name} = \[(.*?)\]", BLOCKS)
        assert found is not None
        assert " ".join(re.findall(r'"(.*?)"', found[1])) == signs
