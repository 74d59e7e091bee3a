"""Compare inferred triples with those of an example; an expected blank node matches any term."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import islice
from typing import TYPE_CHECKING, Final, cast

from pyoxigraph import BlankNode, Triple

from kg.rules.authoring.memory import VOCABULARY

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Mapping, Sequence

    from pyoxigraph import QuerySolutions

    from kg.rules.authoring.examples import Example
    from kg.rules.form import Term
    from kg.store.snapshot import MemorySnapshot

_WAYS: Final = 1000
"""How many ways to read the blank nodes of a block are tried."""


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
        found = _images(each.triples, inferred, world)
        facts += found
        exact.update(found if each.kind == "exactly" else ())
        if each.triples and not found:
            missing += _lacking(each.triples, inferred, world)
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
        known = set(inferred)
        return list(triples) if known.issuperset(triples) else []
    patterns = " . ".join(_pattern(triple, names) for triple in triples)
    ways = islice(_matches(world, patterns, list(names.values())), _WAYS)
    readings = [list(dict.fromkeys(_image(triple, names, way) for triple in triples)) for way in ways]
    return max(readings, key=len, default=[])


def _matches(world: MemorySnapshot, patterns: str, names: Sequence[str]) -> Iterator[dict[str, Term]]:
    """Yield the matches of triple patterns in the inferred triples."""
    columns = " ".join(f"?{name}" for name in names) or "(1 AS ?one)"
    text = f"SELECT DISTINCT {columns} WHERE {{ GRAPH {VOCABULARY.inferred} {{ {patterns} }} }}"
    for row in cast("QuerySolutions", world.query(text)):
        yield {name: cast("Term", row[name]) for name in names}


def _lacking(triples: Sequence[Triple], inferred: Sequence[Triple], world: MemorySnapshot) -> list[Triple]:
    """Return those triples of a block that do not hold by themselves, or all with a blank node where each does."""
    alone = [triple for triple in triples if not _images([triple], inferred, world)]
    return alone or [triple for triple in triples if any(_labels([triple]))]


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
