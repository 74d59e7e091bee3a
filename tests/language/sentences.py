"""Hand-tagged sentences, as read by the tests."""

from __future__ import annotations

from pathlib import Path
from typing import Final

CASES: Final = Path(__file__).parent / "cases"


def tagged(name: str) -> list[list[tuple[str, str]]]:
    """Return the sentences of a file of `word/TAG`, one a line."""
    lines = (CASES / name).read_text("utf-8").splitlines()
    return [[(word, tag) for word, _, tag in (token.rpartition("/") for token in line.split())] for line in lines]


def bracketed(line: str) -> tuple[str, list[str]]:
    """Return a line without its brackets, and their contents."""
    found = [part.split("]")[0] for part in line.split("[")[1:]]
    return line.replace("[", "").replace("]", ""), found
