"""The words of the language that the reader and the printer have to agree upon."""

from __future__ import annotations

import re
from typing import Final

__all__ = ["BARE", "BEGINNINGS", "ENDINGS", "FOREIGN", "FUNCTIONS", "RESERVED", "bare_name", "bare_phrase"]

FUNCTIONS: Final = ("absolute", "round", "count")
"""Functions of one value, written with parentheses."""
BEGINNINGS: Final = frozenset(
    {"if", "while", "forever", "repeat", "for", "break", "set", "wait", "at", "whenever", "as", "log", "stop", "do"}
    | {"program"}
)
"""Words that a statement of the language begins with; all else begins a capability."""
ENDINGS: Final = frozenset({"end", "otherwise", "also", "during"})
"""Words that end a sequence of statements."""
FOREIGN: Final = {
    "else": "Write `otherwise`.",
    "elif": "Write `otherwise if`.",
    "print": 'Write `log "..."`.',
    "let": "Write `set x to 3`.",
    "var": "Write `set x to 3`.",
}
"""Words that statements of other languages begin with, and what is written here; as a capability they are quoted."""
RESERVED: Final = (
    frozenset({"and", "or", "not", "of", "contains", "true", "false", "then", "do", "for", "within", "times"})
    | frozenset({"to", "step"})
    | ENDINGS
)
"""Words that an expression ends at, or that stand for something in it: no bare name of a variable or parameter."""
BARE: Final = re.compile(r"[^\W\d]\w*")


def bare_name(name: str) -> bool:
    """Tell whether a variable, a parameter or a capability in an expression can be written without quotes."""
    return BARE.fullmatch(name) is not None and name.lower() not in RESERVED | set(FUNCTIONS)


def bare_phrase(capability: str) -> bool:
    """Tell whether a statement can begin with a capability without quotes."""
    words = capability.split(" ")
    return all(BARE.fullmatch(word) and word.lower() not in ENDINGS for word in words) and (
        words[0].lower() not in BEGINNINGS | FOREIGN.keys() or (words[0].lower() == "stop" and len(words) > 1)
    )
