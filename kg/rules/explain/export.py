"""Explanations for programs: plain values that JSON can hold, and the Mermaid text of a proof."""

from __future__ import annotations

from typing import TYPE_CHECKING

from kg.rules.explain.proof import Attempt, Condition, Proof, WhyNot

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from pyoxigraph import Triple

    from kg.errors import Place
    from kg.rules.explain.view import View
    from kg.rules.form import Term


def proof_object(proof: Proof, view: View) -> dict[str, object]:
    """Return a proof as `{"fact": N, "facts": [...]}`: each fact once, its premises by their number in the list.

    A fact has `subject`, `predicate`, `object` (as N-Triples spells them), `text`, and either `graphs` and `file` and
    `line`, or `rule`, `rule_file`, `rule_line`, `bindings`, `premises` and `conditions`.
    """
    proofs = {each.fact: each for _, each in proof.walk() if isinstance(each, Proof)}
    order = {fact: number for number, fact in enumerate(proofs)}
    return {"fact": 0, "facts": [_fact_object(each, order, view) for each in proofs.values()]}


def _fact_object(proof: Proof, order: Mapping[Triple, int], view: View) -> dict[str, object]:
    result = _triple(proof.fact, view)
    if proof.derivation is None:
        evidence = proof.evidence
        return result | {
            "graphs": list(proof.graphs),
            "file": evidence.path if evidence else None,
            "line": evidence.line if evidence else None,
        }
    rule = proof.derivation.rule
    conditions: list[dict[str, object]] = []
    for condition in (premise for premise in proof.premises if isinstance(premise, Condition)):
        conditions.append({"text": condition.text})
        if condition.count is not None:
            facts = [_triple(fact, view) for fact in condition.facts]
            conditions[-1] |= {"count": condition.count, "facts": facts}
    return result | {
        "rule": rule.name,
        **_rule_place(rule.place),
        "bindings": _terms(proof.derivation.bindings),
        "premises": [order[premise.fact] for premise in proof.premises if isinstance(premise, Proof)],
        "conditions": conditions,
    }


def _triple(fact: Triple, view: View) -> dict[str, object]:
    return {
        "subject": str(fact.subject),
        "predicate": str(fact.predicate),
        "object": str(fact.object),
        "text": view.sentence(fact),
    }


def _rule_place(place: Place) -> dict[str, object]:
    return {"rule_file": place.path, "rule_line": place.line}


def _terms(bindings: Mapping[str, Term]) -> dict[str, str]:
    return {name: str(term) for name, term in sorted(bindings.items())}


def why_not_object(answer: WhyNot, view: View) -> dict[str, object]:
    """Return why a fact does not hold as plain values; the keys are those of `kg.rules.explain.proof.WhyNot`."""
    return {
        "fact": _triple(answer.fact, view),
        "attempts": [_attempt_object(attempt, view) for attempt in answer.attempts],
        "nearest": list(answer.nearest),
    }


def _attempt_object(attempt: Attempt, view: View) -> dict[str, object]:
    return {
        "rule": attempt.rule.name,
        **_rule_place(attempt.rule.place),
        "bound": _terms(attempt.bound),
        "held": [_triple(fact, view) for fact in attempt.matched],
        "fails": attempt.text if attempt.failing else None,
        "nearest": list(attempt.nearest),
        "deeper": why_not_object(attempt.deeper, view) if attempt.deeper else None,
    }


def mermaid(proofs: Sequence[Proof], view: View) -> str:
    """Return proofs as one Mermaid flowchart: facts are boxes, those inferred rounded, rules are at the arrows."""
    lines: list[str] = []
    links: list[str] = []
    for number, proof in enumerate(proofs):
        steps = {each.fact: each for _, each in proof.walk() if isinstance(each, Proof)}
        names = {fact: f"p{number}f{place}" for place, fact in enumerate(steps)}
        for fact, each in steps.items():
            place = f"<br/>{_escaped(str(each.evidence))}" if each.evidence else ""
            left, right = ("[", "]") if each.derivation is None else ("([", "])")
            lines.append(f'  {names[fact]}{left}"{_escaped(view.sentence(fact))}{place}"{right}')
            rule = _escaped(each.derivation.rule.name) if each.derivation else ""
            below = [premise.fact for premise in each.premises if isinstance(premise, Proof)]
            links += [f'  {names[premise]} -->|"{rule}"| {names[fact]}' for premise in below]
    return "\n".join(["flowchart BT", *lines, *links, ""])


def _escaped(text: str) -> str:
    return text.replace("&", "&amp;").replace("<", "&lt;").replace(">", "&gt;").replace('"', "&quot;")
