"""Which rules, and which parts of rules, never did anything on a store."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from kg.rules.authoring.firing import Firing, fire, holds
from kg.rules.authoring.spelling import spell_element, spell_head
from kg.rules.form import Rule, place_of

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping, Sequence

    from kg.errors import Place
    from kg.rules.authoring.workbench import Try, Workbench
    from kg.rules.engine.limits import Limits
    from kg.rules.files import RuleFile


@dataclass(frozen=True, slots=True)
class Gap:
    """A part that never did anything: `kind` is element (nothing passes it), behind (not reached) or head.

    `part` numbers the rules of one file, from one: those that it states, and those that UNION and OPTIONAL became.
    """

    kind: str
    text: str
    place: Place
    part: int


@dataclass(frozen=True, slots=True)
class RuleCoverage:
    """The rules of one file: how many of their parts did something, of how many, and those that did not."""

    name: str
    rules: int
    fired: int
    covered: int
    parts: int
    gaps: tuple[Gap, ...]


@dataclass(frozen=True, slots=True)
class Coverage:
    """All rules, by name."""

    rules: tuple[RuleCoverage, ...]

    @property
    def fired(self) -> int:
        """How many files have a rule that fired."""
        return sum(rule.fired > 0 for rule in self.rules)

    @property
    def share(self) -> float:
        """The share of parts that did something, from 0 to 1."""
        parts = sum(rule.parts for rule in self.rules)
        return sum(rule.covered for rule in self.rules) / parts if parts else 1.0


def cover(
    bench: Workbench, files: Sequence[RuleFile], chosen: Sequence[RuleFile] = (), limits: Limits | None = None
) -> Coverage:
    """Run the rules of `files` in memory, then apply those of `chosen` (all without it) once to all that is known."""
    tried = bench.infer(files, limits)
    covered = []
    for file in chosen or files:
        prefixes = file.all_prefixes
        firings = list(fire(file.rules, bench.dictionary, tried.asserted, tried.facts))
        gaps = tuple(gap for firing in firings for gap in _gaps(firing, tried, bench, prefixes))
        parts = sum(len(rule.body) + len(rule.head) for rule in file.rules)
        fired = sum(any(len(head) for head in firing.heads) for firing in firings)
        covered.append(RuleCoverage(file.name, len(file.rules), fired, parts - len(gaps), parts, gaps))
    return Coverage(tuple(covered))


def _gaps(firing: Firing, tried: Try, bench: Workbench, prefixes: Mapping[str, str]) -> Iterator[Gap]:
    rule = firing.rule
    first = len(rule.body) if any(len(head) for head in firing.heads) else _stop(rule, tried, bench)
    for number, element in enumerate(rule.body[first:]):
        kind = "behind" if number else "element"
        yield Gap(kind, spell_element(element, prefixes), place_of(element) or rule.place, rule.part)
    for head, facts in zip(rule.head, firing.heads, strict=True):
        if not len(facts):
            yield Gap("head", spell_head(head, prefixes), head.place or rule.place, rule.part)


def _stop(rule: Rule, tried: Try, bench: Workbench) -> int:
    """Return the number of the first element, in the order of the text, that nothing passes."""
    for number in range(1, len(rule.body) + 1):
        if not holds(rule, rule.body[:number], bench.dictionary, tried.asserted, tried.facts):
            return number - 1
    return len(rule.body)


def coverage_objects(coverage: Coverage) -> Iterator[dict[str, Any]]:
    """Yield a plain object for each rule, and one for all, ready for JSON."""
    for rule in coverage.rules:
        yield {
            "rule": rule.name,
            "rules": rule.rules,
            "fired": rule.fired,
            "covered": rule.covered,
            "parts": rule.parts,
            "never": [
                {"kind": gap.kind, "text": gap.text, "file": gap.place.path, "line": gap.place.line, "part": gap.part}
                for gap in rule.gaps
            ],
        }
    yield {
        "coverage": True,
        "rules": len(coverage.rules),
        "fired": coverage.fired,
        "percent": round(100 * coverage.share, 1),
    }
