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
from kg.rules.form import AUXILIARY
from kg.rules.stratify import edges, stratify

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping, Sequence

    from kg.rules.dependencies import Read
    from kg.rules.files import RuleFile
    from kg.rules.form import Atom, Rule

__all__ = ["RuleGraph", "RuleNode", "graph_objects", "graph_picture", "mermaid", "rule_graph", "spell_atom"]

_TYPE: Final = NamedNode("http://www.w3.org/1999/02/22-rdf-syntax-ns#type")
_ANY: Final = "any property"


@dataclass(frozen=True, slots=True)
class RuleNode:
    """One file of rules: the stratum in which the last of its rules runs, and whether it feeds itself there."""

    name: str
    title: str
    stratum: int
    recursive: bool

    @property
    def family(self) -> str:
        """The part of the name before its last slash."""
        return self.name.rpartition("/")[0]


@dataclass(frozen=True, slots=True)
class RuleGraph:
    """Rules by name, who derives a term that others read, and who reads it; True where its absence is asked for."""

    rules: tuple[RuleNode, ...]
    derives: Mapping[tuple[str, str], None]
    reads: Mapping[tuple[str, str], bool]

    @property
    def terms(self) -> list[str]:
        """The terms that pass between rules, sorted."""
        return sorted({term for _, term in self.derives})


_Edges: TypeAlias = "Mapping[str, set[str]]"


def rule_graph(files: Sequence[RuleFile]) -> RuleGraph:
    """Return the dependencies of rules; `RuleError` KG202 and KG204 where they have no strata."""
    titles = {file.name: file.documentation.title for file in files}
    rules = [rule for file in files for rule in file.rules]
    prefixes = {**{name: iri for file in files for name, iri in (file.prefixes or {}).items() if name}, **PREFIXES}
    nodes = {
        rule.name: RuleNode(rule.name, titles[rule.name], stratum.number, stratum.recursive)
        for stratum in stratify(rules)
        for rule in stratum.rules
    }
    derives: dict[tuple[str, str], None] = {}
    readers: dict[tuple[str, str], bool] = {}
    for reader, needs in zip(rules, edges(rules), strict=True):
        for writer in needs:
            for head, read in _joined(rules[writer], reader):
                term = spell_atom(head, prefixes)
                derives[rules[writer].name, term] = None
                readers[term, reader.name] = readers.get((term, reader.name), False) or read.negated
    return RuleGraph(tuple(nodes[name] for name in sorted(nodes)), derives, readers)


def _joined(writer: Rule, reader: Rule) -> Iterator[tuple[Atom, Read]]:
    """Yield the heads of a rule that another reads, with what reads them; names inside one file stay there."""
    for head in writes(writer):
        inner = isinstance(head.predicate, NamedNode) and head.predicate.value.startswith(AUXILIARY)
        for read in reads(reader):
            if not inner and depends(read.atom, head):
                yield head, read


def spell_atom(atom: Atom, prefixes: Mapping[str, str] = PREFIXES) -> str:
    """Return what an atom is about: its property, or for a type its class."""
    if not isinstance(atom.predicate, NamedNode):
        return _ANY
    if atom.predicate == _TYPE and isinstance(atom.object, NamedNode):
        return f"a {spell_term(atom.object, prefixes)}"
    return spell_term(atom.predicate, prefixes)


def graph_picture(graph: RuleGraph, title: str) -> str:
    """Return the graph as SVG."""
    columns = _columns(graph)
    boxes = [
        Box(node.name, columns[node.name], node.name.rpartition("/")[2], node.family, _about(node))
        for node in graph.rules
    ]
    boxes += [Box(f"={term}", columns[f"={term}"], term) for term in graph.terms]
    flows = [Flow(rule, f"={term}") for rule, term in graph.derives]
    flows += [Flow(f"={term}", rule, absent=absent) for (term, rule), absent in graph.reads.items()]
    return draw_flow(title, boxes, flows)


def _about(node: RuleNode) -> str:
    recursive = ", feeds itself" if node.recursive else ""
    return f"{node.name}: {node.title} (stratum {node.stratum}{recursive})"


def _columns(graph: RuleGraph) -> dict[str, int]:
    """Return the column of each rule (even) and term (odd): behind all that it depends on, cycles beside each other."""
    before: dict[str, set[str]] = {node.name: set() for node in graph.rules}
    before |= {f"={term}": set() for term in graph.terms}
    for rule, term in graph.derives:
        before[f"={term}"].add(rule)
    for term, rule in graph.reads:
        before[rule].add(f"={term}")
    home = _components(before)
    needs: dict[str, set[str]] = defaultdict(set)
    for key, sources in before.items():
        needs[home[key]] |= {home[source] for source in sources} - {home[key]}
    members: dict[str, list[str]] = defaultdict(list)
    for key in before:
        members[home[key]].append(key)
    columns: dict[str, int] = {}
    for component in TopologicalSorter({key: needs[key] for key in members}).static_order():
        columns.update(_column_of(members[component], before, columns))
    return columns


def _column_of(members: Sequence[str], before: _Edges, columns: Mapping[str, int]) -> dict[str, int]:
    """Return the columns of rules and terms that feed each other: all rules in one, all terms in the next."""
    first = 0
    for key in members:
        for source in before[key] - set(members):
            first = max(first, columns[source] + 1 - key.startswith("="))
    return {key: first + key.startswith("=") for key in members}


def _components(before: _Edges) -> dict[str, str]:
    """Return for each node the least of those that it feeds and is fed by, itself among them."""
    reach = {key: _reached(key, before) for key in before}
    return {key: min(other for other in reached if key in reach[other]) for key, reached in reach.items()}


def _reached(start: str, edges_of: _Edges) -> set[str]:
    seen, waiting = {start}, [start]
    while waiting:
        fresh = edges_of[waiting.pop()] - seen
        seen |= fresh
        waiting.extend(fresh)
    return seen


def mermaid(graph: RuleGraph) -> str:
    """Return the graph as a Mermaid flowchart."""
    keys = {name: f"r{number}" for number, name in enumerate(node.name for node in graph.rules)}
    terms = {name: f"t{number}" for number, name in enumerate(graph.terms)}
    lines = ["flowchart LR"]
    for family in sorted({node.family for node in graph.rules}):
        lines.append(f'  subgraph {family.replace("/", "_")} ["{family}"]')
        lines += [f'    {keys[node.name]}["{node.name}"]' for node in graph.rules if node.family == family]
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
    writers: dict[str, list[str]] = defaultdict(list)
    for rule, term in sorted(graph.derives):
        writers[term].append(rule)
    for node in graph.rules:
        yield {
            "rule": node.name,
            "title": node.title,
            "stratum": node.stratum,
            "recursive": node.recursive,
            "derives": sorted(term for rule, term in graph.derives if rule == node.name),
            "reads": [
                {"term": term, "negated": absent, "rules": writers[term]}
                for (term, rule), absent in sorted(graph.reads.items())
                if rule == node.name
            ],
        }
