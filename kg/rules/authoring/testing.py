"""Runs the examples of rules: only the rules of the file and those that an example names, in memory.

An expected blank node matches any term.
"""

from __future__ import annotations

import re
import time
from dataclasses import dataclass
from itertools import chain, islice
from typing import TYPE_CHECKING, Any, Final, cast

from pyoxigraph import BlankNode, QuerySolutions, Triple

from kg.errors import KgError, Place, RuleError, UnknownNameError
from kg.rules.authoring.examples import Example, WhyLine, read_examples
from kg.rules.authoring.firing import Firing, fire, holds
from kg.rules.authoring.runs import VOCABULARY, infer, world_of
from kg.rules.authoring.spelling import spell_element, spell_head, spell_term, spell_triple
from kg.rules.authoring.starting import find_rule
from kg.rules.engine.evaluate import Program
from kg.rules.engine.limits import Limits
from kg.rules.explain.proof import Proof
from kg.rules.explain.view import View
from kg.rules.explain.why import why, why_all
from kg.rules.form import Rule, place_of

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Mapping, Sequence

    from kg.rules.authoring.library import Entry, Library
    from kg.rules.authoring.workbench import Try, Workbench
    from kg.rules.files import RuleFile
    from kg.rules.form import Term
    from kg.store.snapshot import MemorySnapshot


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


_LIMITS: Final = Limits(deadline=30.0, max_triples=1_000_000)
"""An example is a few triples: a rule that does not end on it never ends."""
_EMPTY_PREFIX: Final = re.compile(r"(?<![\w:]):(?=\w)")

_WAYS: Final = 1000  # how many ways to read the blank nodes of a block are tried


@dataclass(frozen=True, slots=True)
class Difference:
    """Expected triples that are `missing`, inferred ones that are `unexpected`; `facts`: those found."""

    missing: tuple[Triple, ...]
    unexpected: tuple[Triple, ...]
    facts: tuple[Triple, ...]

    def __bool__(self) -> bool:
        return bool(self.missing or self.unexpected)


def compare(example: Example, inferred: Sequence[Triple], world: MemorySnapshot) -> Difference:
    """Compare inferred triples with all that an example expects."""
    missing: list[Triple] = []
    unexpected: list[Triple] = []
    facts: list[Triple] = []
    exact: set[Triple] = set()
    for each in example.expectations:
        if each.kind == "not":
            unexpected += [fact for triple in each.triples for fact in _images([triple], inferred, world)]
            continue
        images = _images(each.triples, inferred, world)
        facts += images
        exact.update(images if each.kind == "exactly" else ())
        if each.triples and not images:
            # The triples that do not hold by themselves, or all with a blank node where each does.
            alone = [triple for triple in each.triples if not _images([triple], inferred, world)]
            missing += alone or [triple for triple in each.triples if any(_labels([triple]))]
    if any(each.kind == "exactly" for each in example.expectations):
        exact.update(facts)
        unexpected += [triple for triple in inferred if triple not in exact]
    return Difference(*(tuple(dict.fromkeys(each)) for each in (missing, unexpected, facts)))


def _images(triples: Sequence[Triple], inferred: Sequence[Triple], world: MemorySnapshot) -> list[Triple]:
    """Return inferred triples that a block, read as a whole, may match; none if it does not hold.

    Of several matches, that of the most triples is chosen.
    """
    names = {label: f"b{number}" for number, label in enumerate(dict.fromkeys(_labels(triples)))}
    if not names:
        facts = set(inferred)
        return list(triples) if facts.issuperset(triples) else []
    patterns = " . ".join(_pattern(triple, names) for triple in triples)
    columns = " ".join(f"?{name}" for name in names.values())
    text = f"SELECT DISTINCT {columns} WHERE {{ GRAPH {VOCABULARY.inferred} {{ {patterns} }} }}"
    ways = (
        {name: cast("Term", row[name]) for name in names.values()}
        for row in islice(cast("QuerySolutions", world.query(text)), _WAYS)
    )
    readings = [list(dict.fromkeys(_image(triple, names, way) for triple in triples)) for way in ways]
    return max(readings, key=len, default=[])


def _labels(triples: Iterable[Triple]) -> Iterator[str]:
    for triple in triples:
        for term in (triple.subject, triple.object):
            if isinstance(term, BlankNode):
                yield term.value
            elif isinstance(term, Triple):
                yield from _labels([term])


def _pattern(triple: Triple, names: Mapping[str, str]) -> str:
    return f"{_written(triple.subject, names)} {triple.predicate} {_written(triple.object, names)}"


def _written(term: Term, names: Mapping[str, str]) -> str:
    if isinstance(term, BlankNode):
        return f"?{names[term.value]}"
    return f"<<( {_pattern(term, names)} )>>" if isinstance(term, Triple) else str(term)


def _image(triple: Triple, names: Mapping[str, str], way: Mapping[str, Term]) -> Triple:
    def of(term: Term) -> Term:
        if isinstance(term, BlankNode):
            return way[names[term.value]]
        return _image(term, names, way) if isinstance(term, Triple) else term

    return Triple(of(triple.subject), triple.predicate, of(triple.object))  # type: ignore[arg-type]  # subjects match subjects


@dataclass(frozen=True, slots=True)
class Result:
    """Result of one example: triples as the example spells them, lines missing from all proofs, and the proof.

    `error` is set instead when the rule or the page cannot be run; then `title` may be empty.
    """

    rule: str
    title: str
    place: Place
    missing: tuple[str, ...] = ()
    unexpected: tuple[str, ...] = ()
    why_missing: tuple[WhyLine, ...] = ()
    proof: tuple[str, ...] = ()
    error: KgError | None = None
    seconds: float = 0.0

    @property
    def passed(self) -> bool:
        """Whether all was as expected."""
        return not (self.missing or self.unexpected or self.why_missing or self.error)


def parted(entries: Iterable[Entry]) -> tuple[list[Entry], list[Entry]]:
    """Return the rules that have examples, and those that have none."""
    groups: tuple[list[Entry], list[Entry]] = [], []
    for entry in entries:
        groups[not entry.examples.is_file()].append(entry)
    return groups


def run_examples(entries: Iterable[Entry], library: Library) -> Iterator[Result]:
    """Yield the result of each example of some rules; one that cannot be run gives a result even without examples."""
    for entry in entries:
        try:
            file = library.read(entry.name)
            examples = read_examples(entry.examples) if entry.examples.is_file() else ()
        except RuleError as error:
            yield Result(entry.name, "", error.place or Place(str(entry.path)), error=error)
            continue
        programs: dict[tuple[str, ...], Program] = {}
        for example in examples:
            yield run_example(file, example, library, programs)


def run_example(
    file: RuleFile, example: Example, library: Library, programs: dict[tuple[str, ...], Program] | None = None
) -> Result:
    """Run one example of a rule; `programs` caches what the examples of a file share."""
    begin = time.perf_counter()
    try:
        files = [file, *(_other(library, name, place) for name, place in example.others)]
        key = tuple(each.name for each in files)
        cache = {} if programs is None else programs
        if key not in cache:
            program = Program(dict.fromkeys(rule for each in files for rule in each.rules))
            program.refuse_minting()
            cache[key] = program
        data = tuple(triple for each in files for triple in each.data)
        return _judged(file, example, cache[key], data, begin)
    except KgError as error:
        seconds = time.perf_counter() - begin
        return Result(file.name, example.title, example.place, error=error, seconds=seconds)


def _other(library: Library, name: str, place: Place) -> RuleFile:
    try:
        return library.read(find_rule(library, name).name)
    except UnknownNameError as error:
        message = f"the example names an unknown rule, `{name}`"
        raise RuleError("KG221", message, place=place, hint=error.hint) from None


def _judged(file: RuleFile, example: Example, program: Program, data: tuple[Triple, ...], begin: float) -> Result:
    prefixes = {**file.prefixes, **example.prefixes}
    given = (*example.given, *data)
    inferred, _ = infer(program, given, _LIMITS)
    world = world_of(given, inferred)
    difference = compare(example, inferred, world)
    lacking, proof = ((), ()) if difference.missing else _unexplained(example, program.rules, difference.facts, world)
    return Result(
        file.name,
        example.title,
        example.place,
        tuple(spell_triple(triple, prefixes) for triple in difference.missing),
        tuple(spell_triple(triple, prefixes) for triple in difference.unexpected),
        lacking,
        proof,
        None,
        time.perf_counter() - begin,
    )


def _unexplained(
    example: Example, rules: tuple[Rule, ...], facts: Sequence[Triple], world: MemorySnapshot
) -> tuple[tuple[WhyLine, ...], tuple[str, ...]]:
    """Return the lines under `why` that are in no proof of the expected facts, and the shortest proofs then."""
    if not example.why:
        return (), ()
    view = View(world, VOCABULARY)
    shortest = list(chain.from_iterable(_lines(why(view, rules, fact), example.prefixes) for fact in facts))
    lacking = _absent(example.why, shortest)
    if lacking:
        proofs = (proof for fact in facts for proof in why_all(view, rules, fact))
        lacking = _absent(lacking, list(chain.from_iterable(_lines(proof, example.prefixes) for proof in proofs)))
    return lacking, tuple(shortest) if lacking else ()


def _absent(lines: Iterable[WhyLine], proofs: Sequence[str]) -> tuple[WhyLine, ...]:
    """Return the lines that are part of no line of the proofs; the empty prefix is spelt `ex:` there."""
    return tuple(line for line in lines if not any(_EMPTY_PREFIX.sub("ex:", line.text) in proof for proof in proofs))


def _lines(proof: Proof, prefixes: Mapping[str, str]) -> Iterator[str]:
    """Yield the lines of a proof, parents first, two blanks a step."""
    for depth, premise in proof.walk():
        text = spell_triple(premise.fact, prefixes) if isinstance(premise, Proof) else premise.text
        if isinstance(premise, Proof) and premise.derivation is not None:
            bound = sorted(premise.derivation.bindings.items())
            values = ", ".join(f"?{name} = {spell_term(term, prefixes)}" for name, term in bound)
            text += f"  by rule {premise.derivation.rule.name}" + (f" with {values}" if values else "")
        yield "  " * depth + text


def result_object(result: Result) -> dict[str, Any]:
    """Return a result as plain values, ready for JSON."""
    error = result.error
    return {
        "rule": result.rule,
        "example": result.title,
        "passed": result.passed,
        "file": result.place.path,
        "line": result.place.line,
        "missing": list(result.missing),
        "unexpected": list(result.unexpected),
        "why_missing": [line.text for line in result.why_missing],
        "error": {"code": error.code, "message": error.message, "place": str(error.place or "")} if error else None,
        "seconds": round(result.seconds, 4),
    }
