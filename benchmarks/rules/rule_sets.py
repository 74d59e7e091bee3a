"""The rules that are measured: the seventeen, and a part of OWL 2 RL."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Final

from kg.rules.reading import discover

if TYPE_CHECKING:
    from kg.rules.files import RuleSet

__all__ = ["FOLDER", "LATER", "OWL", "owl_rules", "seventeen"]

FOLDER: Final = Path(__file__).parent / "rules"

LATER: Final = ("unheard", "lacks", "listeners")
"""The rules with negation and aggregates, which need the others to be finished."""

OWL: Final = (
    "cax-sco", "scm-sco", "prp-spo1", "scm-spo", "prp-dom", "prp-rng", "prp-symp", "prp-trp", "prp-inv1", "prp-inv2"
)  # fmt: skip
"""The rules of OWL 2 RL (tables 4 to 9 of its profile) that infer anything from the axioms of the graph's schema."""


def seventeen() -> RuleSet:
    """Return the seventeen rules."""
    return discover([FOLDER])


def owl_rules() -> RuleSet:
    """Return the part of OWL 2 RL."""
    every = discover([Path(__file__).parents[2] / "rules"], families=("owl-rl",))
    return replace(every, files=tuple(file for file in every.files if file.name.rpartition("/")[2] in OWL))
