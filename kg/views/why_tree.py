"""Proofs and failed attempts as plain values: nested, with the evidence of each fact and the text of each rule."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Final

from pyoxigraph import NamedNode, Triple

from kg.facts import Location
from kg.graph.iris import Iris
from kg.rules.explain.proof import Attempt, Condition, Derivation, Evidence, Proof, WhyNot
from kg.rules.files import HEADINGS, RuleSet
from kg.views.evidence import Places

if TYPE_CHECKING:
    from collections.abc import Mapping

    from kg.rules.explain.view import View
    from kg.rules.form import Rule, Term

_DEEPEST: Final = 40
"""Maximum number of levels of a proof, since neither programs nor people follow thousands."""


class Telling:
    """Makes plain values of explanations; `base` is that of the IRIs of the store."""

    def __init__(self, view: View, rules: RuleSet, where: Places, base: str) -> None:
        self._view = view
        self._files = {file.name: file for file in rules.files}
        self._where = where
        self._iris = Iris(base)
        self._inferred = self._iris.graph("inferred")

    def proof(self, proof: Proof) -> dict[str, Any]:
        """Return a proof as a tree; see `kg.views.why.why`."""
        return self._proof(proof, set(), 0)

    def _proof(self, proof: Proof, shown: set[Triple], level: int) -> dict[str, Any]:
        derivation = proof.derivation
        node = {**self.triple(proof.fact), "inferred": derivation is not None, "again": False, "cut": False}
        if derivation is None:
            return node | {"graphs": list(proof.graphs), **self._evidence(proof.evidence)}
        node["rule"] = self._rule(derivation.rule)
        node["again"], node["cut"] = proof.fact in shown, level >= _DEEPEST
        if node["again"] or node["cut"]:
            return node | {"bindings": [], "premises": [], "conditions": []}
        shown.add(proof.fact)
        return node | {
            "bindings": self.bindings(derivation.bindings),
            "premises": [self._proof(one, shown, level + 1) for one in proof.premises if isinstance(one, Proof)],
            "conditions": [self._condition(one) for one in proof.premises if not isinstance(one, Proof)],
        }

    def application(self, fact: Triple, derivation: Derivation) -> dict[str, Any]:
        """Return a fact with one application of a rule that gives it: `bindings`, `premises`, `conditions`."""
        return {
            **self.triple(fact),
            "bindings": self.bindings(derivation.bindings),
            "premises": [self._with_evidence(one) for one in derivation.facts],
            "conditions": [self._condition(one) for one in derivation.conditions],
        }

    def triple(self, fact: Triple) -> dict[str, Any]:
        """Return a fact without its proof."""
        parts = {"subject": fact.subject, "predicate": fact.predicate, "object": fact.object}
        return {**{name: self._term(term) for name, term in parts.items()}, "text": self._view.sentence(fact)}

    def lacking(self, answer: WhyNot) -> dict[str, Any]:
        """Return why a fact does not hold; see `kg.views.why.why_not`."""
        return {
            "fact": self.triple(answer.fact),
            "attempts": [self._attempt(one) for one in answer.attempts],
            "nearest": list(answer.nearest),
        }

    def _attempt(self, attempt: Attempt) -> dict[str, Any]:
        return {
            "rule": self._rule(attempt.rule),
            "bindings": self.bindings(attempt.bound),
            "held": [self._with_evidence(fact) for fact in attempt.matched],
            "fails": attempt.text if attempt.failing else None,
            "nearest": list(attempt.nearest),
            "deeper": self.lacking(attempt.deeper) if attempt.deeper else None,
        }

    def _condition(self, condition: Condition) -> dict[str, Any]:
        facts = [self._with_evidence(fact) for fact in condition.facts]
        return {"text": condition.text, "count": condition.count, "facts": facts}

    def _with_evidence(self, fact: Triple) -> dict[str, Any]:
        """Return a fact that is not proven here: with its line, or `inferred`, for a later request."""
        inferred = not self._view.asserted(fact)
        return {
            **self.triple(fact),
            "inferred": inferred,
            **self._evidence(None if inferred else self._view.evidence(fact)),
        }

    def _evidence(self, evidence: Evidence | None) -> dict[str, Any]:
        """Return where a fact was read: in a source, or in a file of `kg` itself."""
        if evidence is None:
            return {"evidence": None, "line_text": None, "line_stored": False}
        thing = self._iris.parse((evidence.thing or "").partition("#")[0])
        if thing is None:
            return {"evidence": Places.own(evidence.path, evidence.line), "line_text": None, "line_stored": False}
        place = Location(evidence.path, evidence.line or 0, evidence.repository)
        return {"evidence": self._where.evidence(thing.parts[0], place), **self._where.code(thing.parts[0], place)}

    def _rule(self, rule: Rule) -> dict[str, Any]:
        file = self._files.get(rule.name)
        sections = file.documentation.sections if file else {}
        return {
            "name": rule.name,
            "title": file.documentation.title if file else "",
            "documentation": [
                {"heading": heading, "text": sections[heading]} for heading in HEADINGS if heading in sections
            ],
            "evidence": Places.own(rule.place.path, rule.place.line),
        }

    def bindings(self, bindings: Mapping[str, Term]) -> list[dict[str, str]]:
        """Return the values of variables, by their names."""
        return [{"name": name, **self._term(term)} for name, term in sorted(bindings.items())]

    def _term(self, term: Term) -> dict[str, str]:
        short = self._view.spelt(term) if isinstance(term, NamedNode) else self._view.label(term)
        return {"term": str(term), "label": self._view.label(term), "short": short}
