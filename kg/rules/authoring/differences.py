"""The triples that a run of the rules on disk would add to a store and remove from it."""

from __future__ import annotations

from collections import Counter
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, TypeAlias

from pyoxigraph import NamedNode, Triple

from kg.rules.authoring.firing import fire
from kg.rules.authoring.runs import triples_of
from kg.rules.authoring.spelling import common_prefixes, spell_term
from kg.rules.columns import stored, union_of
from kg.rules.dependencies import depends
from kg.rules.engine.facts import Facts, intersection, lacking
from kg.rules.form import Atom, Rule
from kg.rules.stratify import edges

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping, Sequence

    from kg.rules.authoring.workbench import Try, Workbench
    from kg.rules.engine.limits import Limits
    from kg.rules.files import RuleFile


@dataclass(frozen=True, slots=True)
class Changed:
    """A triple that comes (`+`) or goes (`-`), with the rules that derive it now, or might have derived it.

    `prefixes` are those that the rules know, and those that mean the same in all files of rules that declare them.
    """

    sign: str
    triple: Triple
    rules: tuple[str, ...]
    prefixes: Mapping[str, str]


@dataclass(frozen=True, slots=True)
class Difference:
    """Triples added and removed, sorted; `tried` is the inference that found them."""

    changes: tuple[Changed, ...]
    tried: Try

    def __bool__(self) -> bool:
        return bool(self.changes)

    def count(self, sign: str) -> int:
        """Return how many triples come or go."""
        return sum(change.sign == sign for change in self.changes)

    @property
    def by_rule(self) -> dict[str, tuple[int, int]]:
        """For each rule that has to do with a change how many triples come and go, sorted."""
        come, gone = (
            Counter(rule for change in self.changes if change.sign == sign for rule in change.rules) for sign in "+-"
        )
        return {rule: (come[rule], gone[rule]) for rule in sorted(come | gone)}


def difference(
    bench: Workbench, files: Sequence[RuleFile], chosen: Sequence[RuleFile] = (), limits: Limits | None = None
) -> Difference:
    """Compare the inferences of the rules of `files` with the inferred triples of the store.

    With `chosen`, only differences due to these rules are returned. The store may differ more if other rules were not
    run, or have changed too. Raises what evaluating the rules raises.
    """
    tried = bench.infer(files, limits)
    now = union_of([stored(tried.outcome.inferred, bench.dictionary), tried.stated])
    come, gone = lacking(now, bench.inferred), lacking(bench.inferred, now)
    names = {file.name for file in chosen}
    fed = _fed_by(tried.rules, names) if names else None
    if names and len(come):
        others = bench.infer([file for file in files if file.name not in names], limits)
        come = lacking(come, others.outcome.inferred)
    common = common_prefixes(files)
    prefixes = {file.name: {**common, **file.prefixes} for file in files}
    changes = [
        Changed(sign, triple, rules, prefixes[rules[0]] if rules else common)
        for sign, triple, rules in (*_added(bench, tried, come), *_removed(bench, tried, gone))
        if sign == "+" or fed is None or fed.intersection(rules)
    ]
    return Difference(tuple(changes), tried)


def _fed_by(rules: Sequence[Rule], names: set[str]) -> set[str]:
    """Return the names of rules with those of the rules that read, directly or not, what they derive."""
    readers: dict[str, set[str]] = {}
    for reader, needs in zip(rules, edges(rules), strict=True):
        for writer in needs:
            readers.setdefault(rules[writer].name, set()).add(reader.name)
    reached, waiting = set(names), list(names)
    while waiting:
        fresh = readers.get(waiting.pop(), set()) - reached
        reached |= fresh
        waiting.extend(fresh)
    return reached


_Item: TypeAlias = "tuple[str, Triple, tuple[str, ...]]"


def _added(bench: Workbench, tried: Try, come: Facts) -> Iterator[_Item]:
    """Yield the triples added, in the order of their spelling, with the rules that derive them."""
    rules: dict[tuple[int, int], set[str]] = {}
    for firing in fire(_deriving(bench, tried, come), bench.dictionary, tried.asserted, tried.facts):
        for predicate, keys in union_of(firing.heads) if firing.heads else Facts():
            for key in intersection(keys, come.keys(predicate)).tolist():
                rules.setdefault((predicate, key), set()).add(firing.rule.name)
    identify = bench.dictionary.intern_term
    for triple in triples_of(come, bench.dictionary):
        key = identify(triple.subject) << 32 | identify(triple.object)
        yield "+", triple, tuple(sorted(rules.get((identify(triple.predicate), key), ())))


def _deriving(bench: Workbench, tried: Try, come: Facts) -> Iterator[Rule]:
    """Yield the rules that may derive some of these triples."""
    predicates = set(come.predicates)
    for rule in tried.rules if predicates else ():
        heads = (head.predicate for head in rule.head)
        if any(not isinstance(head, NamedNode) or bench.dictionary.intern_term(head) in predicates for head in heads):
            yield rule


def _removed(bench: Workbench, tried: Try, gone: Facts) -> Iterator[_Item]:
    """Yield the triples removed, in the order of their spelling, with the rules whose heads match."""
    for triple in triples_of(gone, bench.dictionary):
        atom = Atom(triple.subject, triple.predicate, triple.object)
        names = (rule.name for rule in tried.rules if any(depends(atom, head) for head in rule.head))
        yield "-", triple, tuple(dict.fromkeys(names))


def difference_objects(result: Difference) -> Iterator[dict[str, Any]]:
    """Yield a plain object for each change, and one for all, ready for JSON."""
    for change in result.changes:
        triple = change.triple
        yield {
            "change": change.sign,
            "subject": spell_term(triple.subject, {}),
            "predicate": spell_term(triple.predicate, {}),
            "object": spell_term(triple.object, {}),
            "rules": list(change.rules),
        }
    yield {
        "diff": True,
        "added": result.count("+"),
        "removed": result.count("-"),
        "rules": {rule: {"added": come, "removed": gone} for rule, (come, gone) in result.by_rule.items()},
    }
