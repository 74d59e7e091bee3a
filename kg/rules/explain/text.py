"""Explanations as text: trees of lines, in which a terminal can link the places."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from kg.rules.explain.proof import Attempt, Condition, Evidence, Premise, Proof, WhyNot
from kg.rules.form import Variable, place_of

if TYPE_CHECKING:
    from collections.abc import Iterator

    from pyoxigraph import Triple

    from kg.errors import Place
    from kg.rules.explain.view import View


@dataclass(frozen=True, slots=True)
class Line:
    """One line: the branches of the tree before it, its text, and the line of code or of a rule that it is about.

    `kind` is fact, rule, condition, bindings, failure or hint.
    """

    branches: str
    text: str
    kind: str
    evidence: Evidence | None = None
    place: Place | None = None

    def __str__(self) -> str:
        return f"{self.branches}{self.text}" + (f"  {self.where}" if self.where else "")

    @property
    def where(self) -> str:
        """The place as it can be opened from the working folder."""
        if self.evidence:
            return f"{_from_here(self.evidence.path)}" + (f":{self.evidence.line}" if self.evidence.line else "")
        return f"{_from_here(self.place.path)}:{self.place.line}" if self.place else ""


def _from_here(name: str) -> str:
    path, here = Path(name), Path.cwd()
    return str(path.relative_to(here)) if path.is_relative_to(here) else name


def proof_lines(proof: Proof, view: View) -> Iterator[Line]:
    """Yield a proof as a tree; each fact is explained once."""
    printed: set[Triple] = set()
    # A stack instead of a recursion: a proof may be thousands of steps high.
    waiting: list[tuple[Premise, str, str]] = [(proof, "", "")]
    while waiting:
        premise, branch, below = waiting.pop()
        if not isinstance(premise, Proof):
            yield from _condition(premise, view, branch, below)
            continue
        derivation = premise.derivation
        again = derivation is not None and premise.fact in printed
        yield Line(branch, view.sentence(premise.fact) + (" (as above)" if again else ""), "fact", premise.evidence)
        if derivation is None or again:
            continue
        printed.add(premise.fact)
        inner = below + ("│ " if premise.premises else "  ")
        yield Line(inner, f"by rule {derivation.rule.name}", "rule", place=derivation.rule.place)
        if derivation.bindings:
            values = (f"?{name} = {view.label(term)}" for name, term in sorted(derivation.bindings.items()))
            yield Line(inner, f"with {', '.join(values)}", "bindings")
        for index, child in reversed(list(enumerate(premise.premises))):
            last = index == len(premise.premises) - 1
            waiting.append((child, below + ("└─ " if last else "├─ "), below + ("   " if last else "│  ")))


def _condition(condition: Condition, view: View, branch: str, below: str) -> Iterator[Line]:
    count = "" if condition.count is None else f", over {condition.count}"
    yield Line(branch, condition.text + count, "condition")
    for fact in condition.facts:
        yield Line(below, f"such as {view.sentence(fact)}", "fact", view.evidence(fact))


def why_not_lines(answer: WhyNot, view: View) -> Iterator[Line]:
    """Yield why a fact does not hold: each rule that could derive it, how far it comes, and what exists instead."""
    yield Line("", f"{view.sentence(answer.fact)}: not derived", "fact")
    yield from _absent(answer, view, "")


def _absent(answer: WhyNot, view: View, below: str) -> Iterator[Line]:
    # Rules of any property, as those of OWL, explain little if nothing holds.
    started = [
        attempt
        for attempt in answer.attempts
        if attempt.matched or not any(isinstance(atom.predicate, Variable) for atom in attempt.rule.head)
    ]
    if not started:
        yield Line(f"{below}  ", f"no rule derives {view.spelt(answer.fact.predicate)} facts of this form", "failure")
    for attempt in started:
        yield from _attempt(attempt, view, below, last=attempt is started[-1])
    for text in answer.nearest:
        yield Line(f"{below}  ", f"but {text}" if " has " in text else text, "hint")


def _attempt(attempt: Attempt, view: View, below: str, *, last: bool) -> Iterator[Line]:
    yield Line(below + ("└─ " if last else "├─ "), f"rule {attempt.rule.name}", "rule", place=attempt.rule.place)
    inner = below + ("   " if last else "│  ")
    for fact in attempt.matched:
        yield Line(inner, f"holds: {view.sentence(fact)}", "condition", view.evidence(fact))
    yield Line(inner, f"fails: {attempt.text}", "failure", place=place_of(attempt.failing) if attempt.failing else None)
    if attempt.deeper and attempt.deeper.attempts:
        yield from _absent(attempt.deeper, view, f"{inner}  ")
    else:
        for text in attempt.nearest:
            yield Line(inner, f"nearest: {text}", "hint")
