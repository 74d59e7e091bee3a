"""The look of pictures of systems, apart from their style sheet: signs of kinds and of changes, sizes of letters.

Nothing is told by colour alone: topics have round ends and solid lines, services square ends and dashed lines, actions
cut corners and thick lines; what is new has a `+`, what is gone a `-`, what changed a `~` before its name.
"""

from __future__ import annotations

from typing import Final

from kg.render.svg import short
from kg.render.text import width

NAME: Final = 7.9
"""Width of a letter of a name, in pixels, as wide as those of generic monospace fonts get."""
TERM: Final = 7.3
SMALL: Final = 6.7
SIGNS: Final = {"": "", "new": "+ ", "gone": "- ", "changed": "~ "}


def wide(text: str, letter: float) -> float:
    """Return how many pixels `text` takes with letters of the width `letter`, shortened as it is shown."""
    return width(short(text)) * letter


def outline(kind: str, x: float, y: float, w: float, h: float) -> str:
    """Return the path around a channel: round ends for a topic, cut corners for an action, square for a service."""
    if kind == "service":
        return f"M{x:g} {y:g}h{w:g}v{h:g}h{-w:g}z"
    if kind == "action":
        return f"M{x + 6:g} {y:g}h{w - 12:g}l6 6v{h - 12:g}l-6 6h{12 - w:g}l-6 -6v{12 - h:g}z"
    return f"M{x + 8:g} {y:g}h{w - 16:g}q8 0 8 8v{h - 16:g}q0 8 -8 8h{16 - w:g}q-8 0 -8 -8v{16 - h:g}q0 -8 8 -8z"
