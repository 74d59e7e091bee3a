"""KG215: a rule that derives what no other rule and no stored query reads."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

from pyoxigraph import NamedNode

from kg.rules.checks.finding import Finding
from kg.rules.checks.standard import STANDARD
from kg.rules.checks.tokens import place_of_name
from kg.rules.dependencies import depends, reads
from kg.rules.form import AUXILIARY, Variable
from kg.syntax.names import PREFIXES, shorten

if TYPE_CHECKING:
    from collections.abc import Iterator

    from kg.rules.checks.finding import Context
    from kg.rules.files import RuleFile
    from kg.rules.form import Atom

__all__ = ["CODE", "TITLE", "check"]

CODE: Final = "KG215"
TITLE: Final = "head never read"
_OTHERS: Final = (AUXILIARY, *STANDARD)
"""Namespaces of what only decomposition reads, and of what is read everywhere."""

_TYPE: Final = NamedNode(PREFIXES["rdf"] + "type")


def check(file: RuleFile, context: Context) -> Iterator[Finding]:
    """Yield each property or class that a file derives and nothing else mentions; reports are read by people."""
    if file.documentation.severity:
        return
    told: set[str] = set()
    for atom in (atom for rule in file.rules for atom in rule.head):
        what = atom.object if atom.predicate == _TYPE else atom.predicate
        if not isinstance(what, NamedNode) or what.value in told or what.value.startswith(_OTHERS):
            continue
        if what.value not in context.read and not _read_by_rules(atom, file, context):
            told.add(what.value)
            message = f"nothing reads {shorten(what.value)}: no other rule, no stored query"
            hint = "Write a stored query that shows it, or leave it out."
            yield Finding(CODE, "note", file.name, message, place_of_name(file, what.value), hint)


def _read_by_rules(head: Atom, file: RuleFile, context: Context) -> bool:
    others = (rule for rule in context.cut or context.rules.rules if rule.name != file.name)
    return any(depends(read.atom, head) for rule in others for read in reads(rule) if _chooses(read.atom))


def _chooses(atom: Atom) -> bool:
    """Return whether an atom reads some triples only, not all, as a copy under another name does."""
    return any(not isinstance(position, Variable) for position in atom.positions)
