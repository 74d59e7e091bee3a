"""Rules in SPARQL CONSTRUCT (`.rq`)."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

from kg.rules.decompose import decompose

if TYPE_CHECKING:
    from kg.rules.form import Rule
    from kg.syntax.tree import RuleUnit

__all__ = ["rules"]


def rules(unit: RuleUnit, name: str, path: str, text: str) -> tuple[Rule, ...]:
    """Return the rules of a file that was parsed, their parts numbered from one.

    Raises RuleError as `decompose` does: KG203 for what the body does not bind.
    """
    every = [rule for stated in unit.rules for rule in decompose(stated, name, path, text)]
    return tuple(replace(rule, part=part) for part, rule in enumerate(every, 1))
