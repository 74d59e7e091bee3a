"""Why a system or a package has a capability: proofs down to the line of code, or to the peer that was seen."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from pyoxigraph import NamedNode, Triple

from kg.errors import RobotError
from kg.graph import vocabulary as v
from kg.rules.explain.why import why
from kg.similar import did_you_mean, folded

if TYPE_CHECKING:
    from collections.abc import Iterator

    from kg.robot.capabilities.definitions import Askable
    from kg.robot.capability import Capabilities, Capability
    from kg.rules.explain.proof import Proof
    from kg.rules.explain.view import View
    from kg.rules.form import Rule

__all__ = ["find", "proofs"]

_HOLDERS = """SELECT DISTINCT ?node WHERE {
  <%s> <https://w3id.org/rnkg/ns#hasInstance>|<https://w3id.org/rnkg/ns#contains> ?node .
  ?node <https://w3id.org/rnkg/ns#hasCapability> <%s> .
} ORDER BY ?node"""


def find(capabilities: Capabilities, name: str) -> Capability:
    """Return the capability that a name means: its own, its label, another name of it, or its IRI.

    Raises RobotError KG818 when there is none, with what was probably meant.
    """
    wanted = folded(name.strip().removeprefix("capability:"))
    for one in capabilities.capabilities:
        if wanted in {folded(text) for text in (one.name, one.label, one.iri, *one.alternatives)}:
            return one
    known = [text for one in capabilities.capabilities for text in (one.name, one.label)]
    raise RobotError("KG818", f"{capabilities.of} has no capability `{name}`", hint=did_you_mean(name, known))


def proofs(graph: Askable, view: View, rules: tuple[Rule, ...], whole: str, capability: Capability) -> Iterator[Proof]:
    """Yield for each node of a system or package that has a capability why it does, the shortest way.

    `view` is how explanations with these rules see the graph. Raises RuleError KG226 for what rules do not derive.
    """
    rows: Any = graph.query(_HOLDERS % (whole, capability.iri))
    predicate = NamedNode(v.bare(v.rnkg("hasCapability")))
    for node in [row["node"] for row in rows]:
        yield why(view, rules, Triple(node, predicate, NamedNode(capability.iri)), shortest=True)
