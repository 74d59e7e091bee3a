"""The record of a run of rules in the graph of builds: one activity (PROV-O), and the triples by rule.

    <run/2026-01-31T12:00:00+00:00> a prov:Activity, rnkg:RuleRun ;
        prov:startedAtTime, prov:endedAtTime "..."^^xsd:dateTime ; prov:generated <graph/inferred> ;
        rnkg:inferredCount 170412 ; prov:qualifiedUsage <run/...#communication/feeds> .
    <run/...#communication/feeds> a prov:Usage ; prov:entity <rule/communication/feeds> ;
        sh:sourceRule <rule/communication/feeds> ; rnkg:inferredCount 5120 .

Inferred triples carry no statement of their rule; it is computed on request.
"""

from __future__ import annotations

from dataclasses import dataclass
from hashlib import blake2b
from typing import TYPE_CHECKING, Final
from urllib.parse import quote

from pyoxigraph import NamedNode

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping
    from datetime import datetime

    from kg.rules.files import RuleSet

_PROV: Final = "http://www.w3.org/ns/prov#"
_TYPE: Final = "<http://www.w3.org/1999/02/22-rdf-syntax-ns#type>"
_XSD: Final = "http://www.w3.org/2001/XMLSchema#"
_SOURCE_RULE: Final = "<http://www.w3.org/ns/shacl#sourceRule>"


@dataclass(frozen=True, slots=True)
class Names:
    """The graphs that a run writes, the base of the IRIs of rules and runs, and the namespace of its own terms."""

    inferred: NamedNode
    builds: NamedNode
    base: str
    vocabulary: str

    @classmethod
    def of(cls, base: str, vocabulary: str) -> Names:
        """Return the names below a base: `<base>graph/inferred` and `<base>graph/builds`."""
        return cls(NamedNode(f"{base}graph/inferred"), NamedNode(f"{base}graph/builds"), base, vocabulary)

    def read_by_rules(self, graphs: Iterable[NamedNode]) -> list[NamedNode | None]:
        """Return the graphs that rules read: those given but for what runs write, and the default graph as None."""
        return [*(graph for graph in graphs if graph not in {self.inferred, self.builds}), None]

    def digest(self, rule_set: RuleSet) -> str:
        """Return the digest of a set of rules and of the graphs that it leaves out."""
        return blake2b(f"{self} {rule_set.digest}".encode(), digest_size=16).hexdigest()

    def rule(self, name: str) -> str:
        """Return the IRI of a rule."""
        return f"{self.base}rule/{quote(name, safe='/')}"


def activity(names: Names, started: datetime, ended: datetime, triples: int, derived: Mapping[str, int]) -> bytes:
    """Return the N-Triples about one run; `derived` counts what each rule, by name, was the first to derive."""
    run = f"{names.base}run/{quote(started.isoformat(), safe=':')}"
    count = f"<{names.vocabulary}inferredCount>"
    lines = [
        f"<{run}> {_TYPE} <{_PROV}Activity>",
        f"<{run}> {_TYPE} <{names.vocabulary}RuleRun>",
        f"<{run}> <{_PROV}startedAtTime> {_moment(started)}",
        f"<{run}> <{_PROV}endedAtTime> {_moment(ended)}",
        f"<{run}> <{_PROV}generated> {names.inferred}",
        f"<{run}> {count} {_number(triples)}",
    ]
    for name, number in sorted(derived.items()):
        usage, rule = f"{run}#{quote(name, safe='/')}", names.rule(name)
        lines += [
            f"<{run}> <{_PROV}qualifiedUsage> <{usage}>",
            f"<{usage}> {_TYPE} <{_PROV}Usage>",
            f"<{usage}> <{_PROV}entity> <{rule}>",
            f"<{usage}> {_SOURCE_RULE} <{rule}>",
            f"<{usage}> {count} {_number(number)}",
        ]
    return "".join(f"{line} .\n" for line in lines).encode()


def _moment(time: datetime) -> str:
    return f'"{time.isoformat()}"^^<{_XSD}dateTime>'


def _number(number: int) -> str:
    return f'"{number}"^^<{_XSD}integer>'
