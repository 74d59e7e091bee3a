"""Proofs as lines of text, as an SVG picture of these lines, as values for JSON, and as Mermaid."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Final
from xml.sax.saxutils import escape

from kg.render.svg import stylesheet
from kg.rules.explain.proof import Attempt, Condition, Evidence, Premise, Proof, WhyNot
from kg.rules.form import Variable, place_of

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping, Sequence

    from pyoxigraph import Triple

    from kg.errors import Place
    from kg.rules.explain.view import View
    from kg.rules.form import Term


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


_ROW: Final = 22
_CHAR: Final = 7.9
_STEP: Final = 22
_MARGIN: Final = 16


def picture(proofs: Sequence[Proof], view: View) -> str:
    """Return proofs, one below the other, as one SVG; text only, the same for the same proofs."""
    lines = [line for proof in proofs for line in proof_lines(proof, view)]
    texts = (f"{line.text}  {line.where}" if line.where else line.text for line in lines)
    width = max(_MARGIN * 2 + _left(line) + len(text) * _CHAR for line, text in zip(lines, texts, strict=True))
    height = _MARGIN * 2 + len(lines) * _ROW
    body = "\n".join([*_guides(lines), *(_text(line, row) for row, line in enumerate(lines))])
    title = escape(lines[0].text)
    return (
        f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {width:.0f} {height}" width="{width:.0f}" '
        f'height="{height}" role="img" aria-label="Proof of {escape(title, {chr(34): "&quot;"})}">\n'
        f"<title>{title}</title>\n<style>\n{stylesheet('proof')}\n</style>\n{body}\n</svg>\n"
    )


def _depth(line: Line) -> int:
    """Return how many branches are before a line: each is three signs wide, the last of a rule's line two."""
    return (len(line.branches) + 1) // 3


def _left(line: Line) -> float:
    return _depth(line) * _STEP


def _baseline(row: int) -> float:
    return _MARGIN + row * _ROW + 15


def _text(line: Line, row: int) -> str:
    place = f'<tspan class="place" dx="14">{escape(line.where)}</tspan>' if line.where else ""
    left = _MARGIN + _left(line)
    return f'<text class="{line.kind}" x="{left:g}" y="{_baseline(row):g}">{escape(line.text)}{place}</text>'


def _guides(lines: Sequence[Line]) -> Iterator[str]:
    """Yield the lines of the tree: from each fact down its premises."""
    for row, line in enumerate(lines):
        if line.kind != "fact" or not line.branches:
            continue
        depth = _depth(line)
        above = next((index for index in range(row - 1, -1, -1) if _depth(lines[index]) < depth), 0)
        x = _MARGIN + depth * _STEP - _STEP / 2
        y = _baseline(row) - 5
        yield f'<line x1="{x:g}" y1="{_baseline(above) + 4:g}" x2="{x:g}" y2="{y:g}"/>'
        yield f'<line x1="{x:g}" y1="{y:g}" x2="{x + _STEP / 2 - 3:g}" y2="{y:g}"/>'


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
