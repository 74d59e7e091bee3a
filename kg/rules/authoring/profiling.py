"""Profile of a run: time, rounds and triples by rule, and the rows after each element of a body."""

from __future__ import annotations

import time
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from kg.rules.authoring.firing import fire
from kg.rules.authoring.spelling import spell_element
from kg.rules.form import place_of

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from kg.errors import Place
    from kg.rules.authoring.workbench import Try, Workbench
    from kg.rules.engine.evaluate import RuleReport
    from kg.rules.engine.limits import Limits
    from kg.rules.files import RuleFile


@dataclass(frozen=True, slots=True)
class ElementProfile:
    """An element of a body, with its rows and seconds when the rule is applied once to all that is known.

    `order` is the place in which the engine chose to run it, None for one that was not reached.
    """

    text: str
    place: Place
    part: int
    order: int | None
    rows_in: int
    rows_out: int
    seconds: float


@dataclass(frozen=True, slots=True)
class RuleProfile:
    """The rules of one file: how long they ran, in how many rounds, how much they were the first to derive."""

    name: str
    stratum: int
    rules: int
    rounds: int
    derived: int
    seconds: float
    elements: tuple[ElementProfile, ...] = ()


@dataclass(frozen=True, slots=True)
class Profile:
    """A run, the dearest rule first; seconds of reading, of evaluation, and triples read and inferred."""

    rules: tuple[RuleProfile, ...]
    reading: float
    evaluating: float
    asserted: int
    inferred: int


def profile(
    bench: Workbench, files: Sequence[RuleFile], detailed: Sequence[str] = (), limits: Limits | None = None
) -> Profile:
    """Run the rules of some files in memory and profile each; those in `detailed` element by element."""
    begin = time.perf_counter()
    bench.read(files)
    reading = time.perf_counter() - begin
    tried = bench.infer(files, limits)
    groups: dict[str, list[RuleReport]] = {}
    for report in tried.outcome.reports:
        groups.setdefault(report.rule.name, []).append(report)
    by_name = {file.name: file for file in files}
    rules = [
        RuleProfile(
            name,
            max(report.stratum for report in reports),
            len(reports),
            max(report.rounds for report in reports),
            sum(report.derived for report in reports),
            sum(report.seconds for report in reports),
            tuple(_elements(by_name[name], tried, bench)) if name in detailed else (),
        )
        for name, reports in groups.items()
    ]
    rules.sort(key=lambda rule: (-rule.seconds, rule.name))
    evaluating = time.perf_counter() - begin - reading
    return Profile(tuple(rules), reading, evaluating, len(tried.read), len(tried.outcome.inferred))


def _elements(file: RuleFile, tried: Try, bench: Workbench) -> Iterator[ElementProfile]:
    """Yield the elements of a file's rules as they are written, not as they are cut to a schema."""
    for firing in fire(file.rules, bench.dictionary, tried.asserted, tried.facts):
        rule = firing.rule
        for number, element in enumerate(rule.body):
            text, place = spell_element(element, file.all_prefixes), place_of(element) or rule.place
            passage = firing.passages.get(number)
            if passage is None:
                yield ElementProfile(text, place, rule.part, None, 0, 0, 0.0)
            else:
                rows = passage.rows_in, passage.rows_out
                yield ElementProfile(text, place, rule.part, passage.order + 1, *rows, passage.seconds)


def profile_objects(result: Profile) -> Iterator[dict[str, Any]]:
    """Yield a plain object for each rule, and one for the run, ready for JSON."""
    for rule in result.rules:
        yield {
            "rule": rule.name,
            "stratum": rule.stratum,
            "rules": rule.rules,
            "rounds": rule.rounds,
            "derived": rule.derived,
            "seconds": round(rule.seconds, 6),
            "elements": [
                {
                    "text": element.text,
                    "file": element.place.path,
                    "line": element.place.line,
                    "part": element.part,
                    "order": element.order,
                    "rows_in": element.rows_in,
                    "rows_out": element.rows_out,
                    "seconds": round(element.seconds, 6),
                }
                for element in rule.elements
            ],
        }
    yield {
        "profile": True,
        "asserted": result.asserted,
        "inferred": result.inferred,
        "seconds": {"reading": round(result.reading, 6), "evaluating": round(result.evaluating, 6)},
    }
