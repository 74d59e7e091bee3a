"""Which rules feed which: rules, and between them the terms that some derive and others read."""

from __future__ import annotations

from collections import defaultdict
from dataclasses import dataclass
from graphlib import TopologicalSorter
from typing import TYPE_CHECKING, Any, Final, TypeAlias

from pyoxigraph import NamedNode

from kg.query.prefixes import PREFIXES
from kg.render.flow_picture import Box, Flow, draw_flow
from kg.rules.authoring.spelling import spell_term
from kg.rules.dependencies import depends, reads, writes
from kg.rules.form import AUXILIARY, Variable
from kg.rules.specialise import specialise
from kg.rules.stratify import edges, stratify

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Mapping, Sequence

    from pyoxigraph import Triple

    from kg.rules.dependencies import Read
    from kg.rules.files import RuleFile
    from kg.rules.form import Atom, Rule

__all__ = ["RuleGraph", "RuleNode", "graph_objects", "graph_picture", "is_inner", "mermaid", "rule_graph", "spell_atom"]

_TYPE: Final = NamedNode("http://www.w3.org/1999/02/22-rdf-syntax-ns#type")
_ANY_PROPERTY: Final = "any property"
_ANY_CLASS: Final = "any class"


@dataclass(frozen=True, slots=True)
class RuleNode:
    """The rules of one file that stand in one column: the strata in which they run, and whether one feeds itself."""

    key: str
    name: str
    title: str
    column: int
    strata: tuple[int, ...]
    recursive: bool

    @property
    def family(self) -> str:
        """The part of the name before its last slash."""
        return self.name.rpartition("/")[0]

    @property
    def when(self) -> str:
        """The strata in words."""
        first, last = self.strata[0], self.strata[-1]
        return f"stratum {first}" if first == last else f"strata {first} to {last}"


@dataclass(frozen=True, slots=True)
class RuleGraph:
    """Rules, who derives a term that others read, and who reads it; True where its absence or number is asked for.

    `terms` have a column too: rules stand in even ones, terms in odd ones, behind all that they depend on.
    """

    rules: tuple[RuleNode, ...]
    terms: Mapping[str, int]
    derives: Mapping[tuple[str, str], None]
    reads: Mapping[tuple[str, str], bool]

    def fed_by(self, name: str) -> list[str]:
        """Return the other rules that derive what a rule reads."""
        terms = {term for term, key in self.reads if self._names[key] == name}
        return sorted({self._names[key] for key, term in self.derives if term in terms} - {name})

    def feeds(self, name: str) -> list[str]:
        """Return the other rules that read what a rule derives."""
        terms = {term for key, term in self.derives if self._names[key] == name}
        return sorted({self._names[key] for term, key in self.reads if term in terms} - {name})

    @property
    def _names(self) -> dict[str, str]:
        return {node.key: node.name for node in self.rules}


_Before: TypeAlias = "Mapping[int | str, set[int | str]]"
"""Rules by number and terms by name, with those that they directly depend on."""


def rule_graph(files: Sequence[RuleFile], schema: Iterable[Triple] = ()) -> RuleGraph:
    """Return the dependencies of rules, those over any schema cut to `schema`.

    Raises:
        RuleError: KG202 and KG204 where they have no strata.
    """
    prefixes = _prefixes(files)
    rules = specialise((rule for file in files for rule in file.rules), schema)
    derives: dict[tuple[int, str], None] = {}
    readers: dict[tuple[str, int], bool] = {}
    for number, needs in enumerate(edges(rules)):
        for writer in needs:
            for head, read in _joined(rules[writer], rules[number]):
                term = f"steps of {rules[writer].name}" if is_inner(head) else _passed(head, read.atom, prefixes)
                derives[writer, term] = None
                readers[term, number] = readers.get((term, number), False) or read.negated
    before: dict[int | str, set[int | str]] = {number: set() for number in range(len(rules))}
    for writer, term in derives:
        before.setdefault(term, set()).add(writer)
    for term, number in readers:
        before[number].add(term)
    columns = _columns(before)
    keys = [f"{rule.name}@{columns[number]}" for number, rule in enumerate(rules)]
    return RuleGraph(
        _nodes(files, rules, keys, columns),
        {term: columns[term] for term in sorted(term for term in columns if isinstance(term, str))},
        {(keys[writer], term): None for writer, term in derives},
        _merged(readers, keys),
    )


def _prefixes(files: Sequence[RuleFile]) -> dict[str, str]:
    """Return the prefixes that everyone knows, and those that mean the same in all files that declare them."""
    meant: dict[str, set[str]] = defaultdict(set)
    for file in files:
        for name, iri in (file.prefixes or {}).items():
            meant[name].add(iri)
    return {**{name: next(iter(iris)) for name, iris in meant.items() if len(iris) == 1}, **PREFIXES}


def _merged(readers: Mapping[tuple[str, int], bool], keys: Sequence[str]) -> dict[tuple[str, str], bool]:
    found: dict[tuple[str, str], bool] = {}
    for (term, number), negated in readers.items():
        found[term, keys[number]] = found.get((term, keys[number]), False) or negated
    return found


def _nodes(
    files: Sequence[RuleFile], rules: Sequence[Rule], keys: Sequence[str], columns: Mapping[int | str, int]
) -> tuple[RuleNode, ...]:
    titles = {file.name: file.documentation.title for file in files}
    where = {id(rule): stratum for stratum in stratify(rules) for rule in stratum.rules}
    members: dict[str, list[int]] = defaultdict(list)
    for number, key in enumerate(keys):
        members[key].append(number)
    nodes = []
    for key, numbers in members.items():
        strata = [where[id(rules[number])] for number in numbers]
        name = rules[numbers[0]].name
        ran = tuple(sorted({stratum.number for stratum in strata}))
        recursive = any(stratum.recursive for stratum in strata)
        nodes.append(RuleNode(key, name, titles[name], columns[numbers[0]], ran, recursive))
    return tuple(sorted(nodes, key=lambda node: (node.name, node.column)))


def _joined(writer: Rule, reader: Rule) -> Iterator[tuple[Atom, Read]]:
    """Yield the heads of a rule that another reads, with what reads them."""
    for head in writes(writer):
        for read in reads(reader):
            if depends(read.atom, head):
                yield head, read


def _passed(head: Atom, read: Atom, prefixes: Mapping[str, str]) -> str:
    """Return what passes: what is derived, or where the reader takes any of a kind, that kind."""
    if isinstance(read.predicate, Variable):
        return _ANY_PROPERTY
    open_class = read.predicate == _TYPE and isinstance(read.object, Variable)
    return _ANY_CLASS if open_class else spell_atom(head, prefixes)


def is_inner(atom: Atom) -> bool:
    """Tell whether an atom has a predicate that decomposition introduced, which passes between rules of one file."""
    return isinstance(atom.predicate, NamedNode) and atom.predicate.value.startswith(AUXILIARY)


def spell_atom(atom: Atom, prefixes: Mapping[str, str] = PREFIXES) -> str:
    """Return what an atom is about: its property, or for a type its class."""
    if not isinstance(atom.predicate, NamedNode):
        return _ANY_PROPERTY
    if atom.predicate == _TYPE:
        return f"a {spell_term(atom.object, prefixes)}" if isinstance(atom.object, NamedNode) else _ANY_CLASS
    return spell_term(atom.predicate, prefixes)


def graph_picture(graph: RuleGraph, title: str) -> str:
    """Return the graph as SVG."""
    boxes = [
        Box(node.key, node.column, node.name.rpartition("/")[2], node.family, _about(node)) for node in graph.rules
    ]
    boxes += [Box(f"={term}", column, term) for term, column in graph.terms.items()]
    flows = [Flow(key, f"={term}") for key, term in graph.derives]
    flows += [Flow(f"={term}", key, absent=absent) for (term, key), absent in graph.reads.items()]
    return draw_flow(title, boxes, flows)


def _about(node: RuleNode) -> str:
    recursive = ", feeds itself" if node.recursive else ""
    return f"{node.name}: {node.title} ({node.when}{recursive})"


def _columns(before: _Before) -> dict[int | str, int]:
    """Return the column of each rule (even) and term (odd): behind all that it depends on, cycles beside each other."""
    home = _components(before)
    needs: dict[int | str, set[int | str]] = {key: set() for key in dict.fromkeys(home.values())}
    members: dict[int | str, list[int | str]] = defaultdict(list)
    for key, sources in before.items():
        needs[home[key]] |= {home[source] for source in sources} - {home[key]}
        members[home[key]].append(key)
    columns: dict[int | str, int] = {}
    for component in TopologicalSorter(needs).static_order():
        columns.update(_column_of(members[component], before, columns))
    return columns


def _column_of(members: Sequence[int | str], before: _Before, columns: Mapping[int | str, int]) -> dict[int | str, int]:
    """Return the columns of rules and terms that feed each other: all rules in one, all terms in the next."""
    first = 0
    for key in members:
        for source in before[key] - set(members):
            first = max(first, columns[source] + 1 - isinstance(key, str))
    return {key: first + isinstance(key, str) for key in members}


def _components(before: _Before) -> dict[int | str, int | str]:
    """Return for each node one of those that it feeds and is fed by, the same for all of them."""
    reach = {key: _reached(key, before) for key in before}
    found: dict[int | str, int | str] = {}
    for key, reached in reach.items():
        if key not in found:
            found.update({other: key for other in reached if key in reach[other]})
    return found


def _reached(start: int | str, before: _Before) -> set[int | str]:
    seen, waiting = {start}, [start]
    while waiting:
        fresh = before[waiting.pop()] - seen
        seen |= fresh
        waiting.extend(fresh)
    return seen


def mermaid(graph: RuleGraph) -> str:
    """Return the graph as a Mermaid flowchart."""
    keys = {node.key: f"r{number}" for number, node in enumerate(graph.rules)}
    terms = {name: f"t{number}" for number, name in enumerate(graph.terms)}
    lines = ["flowchart LR"]
    for number, family in enumerate(sorted({node.family for node in graph.rules})):
        lines.append(f'  subgraph f{number} ["{_quoted(family)}"]')
        lines += [f'    {keys[node.key]}["{_quoted(node.name)}"]' for node in graph.rules if node.family == family]
        lines.append("  end")
    lines += [f'  {key}(["{_quoted(name)}"])' for name, key in terms.items()]
    lines += [f"  {keys[rule]} --> {terms[term]}" for rule, term in sorted(graph.derives)]
    lines += [
        f"  {terms[term]} {'-. absent .->' if absent else '-->'} {keys[rule]}"
        for (term, rule), absent in sorted(graph.reads.items())
    ]
    return "\n".join(lines) + "\n"


def _quoted(text: str) -> str:
    return text.replace('"', "#quot;").replace("<", "&lt;").replace(">", "&gt;")


def graph_objects(graph: RuleGraph) -> Iterator[dict[str, Any]]:
    """Yield a plain object for each rule: what it derives for others, and which rules it reads through which term."""
    names = {node.key: node.name for node in graph.rules}
    writers: dict[str, set[str]] = defaultdict(set)
    for key, term in graph.derives:
        writers[term].add(names[key])
    for name in dict.fromkeys(names.values()):
        nodes = [node for node in graph.rules if node.name == name]
        read: dict[str, bool] = {}
        for (term, key), absent in sorted(graph.reads.items()):
            if names[key] == name:
                read[term] = read.get(term, False) or absent
        yield {
            "rule": name,
            "title": nodes[0].title,
            "strata": sorted({number for node in nodes for number in node.strata}),
            "recursive": any(node.recursive for node in nodes),
            "derives": sorted({term for key, term in graph.derives if names[key] == name}),
            "reads": [
                {"term": term, "negated": absent, "rules": sorted(writers[term])} for term, absent in read.items()
            ],
        }
