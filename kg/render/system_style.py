"""What pictures of systems look like: colours for light and dark, signs of kinds and of changes, sizes of letters.

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
STYLE: Final = """
svg { background: #ffffff; font-family: ui-monospace, SFMono-Regular, Menlo, Consolas, "DejaVu Sans Mono", monospace; }
.box { fill: #eef3f8; stroke: #34495e; stroke-width: 1.5; } .host { fill: #f7f9fb; stroke: #8595a5; stroke-width: 1.5; }
.many { fill: #e2eaf2; stroke: #34495e; stroke-width: 1.5; } .unknown { stroke-dasharray: 5 4; }
.sign { fill: #ffffff; stroke-width: 1.5; }
.topic { stroke: #1f6f43; } .service { stroke: #8a4b08; } .action { stroke: #6b3fa0; }
.way { fill: none; stroke-width: 1.4; stroke-linejoin: round; }
.way.service { stroke-dasharray: 6 4; } .way.action { stroke-width: 2.6; }
.head { stroke: none; } .head.topic { fill: #1f6f43; } .head.service { fill: #8a4b08; } .head.action { fill: #6b3fa0; }
.title { font-size: 17px; font-weight: bold; fill: #17202a; } .key { font-size: 11px; fill: #4d5a66; }
.name { font-size: 13px; font-weight: bold; fill: #17202a; } .term { font-size: 12px; fill: #17202a; }
.sub { font-size: 11px; fill: #4d5a66; } .loose { font-size: 11px; fill: #7a3b12; } .mark { stroke-width: 1.3; }
.way:hover { stroke-width: 4; }
.new.box, .new.sign, .new.host, .new.many { stroke: #14743c; fill: #e0f5e6; stroke-width: 2.5; }
.gone.box, .gone.sign, .gone.host, .gone.many { stroke: #b3261e; fill: #fbe6e4; stroke-width: 2.5; }
.changed.box, .changed.sign, .changed.host, .changed.many { stroke: #8a5a00; fill: #fdf1d3; stroke-width: 2.5; }
.way.new { stroke: #14743c; stroke-width: 2.6; } .head.new { fill: #14743c; }
.way.gone { stroke: #b3261e; stroke-width: 2.6; stroke-dasharray: 2 4; } .head.gone { fill: #b3261e; }
.still { opacity: 0.55; }
@media (prefers-color-scheme: dark) {
svg { background: #14191f; } .box { fill: #1f2933; stroke: #9fb3c8; } .host { fill: #191f27; stroke: #6d7f90; }
.many { fill: #2a3643; stroke: #9fb3c8; } .sign { fill: #14191f; }
.topic { stroke: #6fcf97; } .service { stroke: #f2b26b; } .action { stroke: #c39bf0; }
.head.topic { fill: #6fcf97; } .head.service { fill: #f2b26b; } .head.action { fill: #c39bf0; }
.title, .name, .term { fill: #f0f4f8; } .sub, .key { fill: #b3c0cc; } .loose { fill: #f2b98b; }
.new.box, .new.sign, .new.host, .new.many { stroke: #6fcf97; fill: #12301f; }
.gone.box, .gone.sign, .gone.host, .gone.many { stroke: #ff8f7a; fill: #3a1815; }
.changed.box, .changed.sign, .changed.host, .changed.many { stroke: #f0c25a; fill: #33270a; }
.way.new { stroke: #6fcf97; } .head.new { fill: #6fcf97; } .way.gone { stroke: #ff8f7a; } .head.gone { fill: #ff8f7a; }
}"""


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
