"""Which rules feed which: rules, and between them the terms that some derive and others read."""

from __future__ import annotations

from collections import defaultdict
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Final

from pyoxigraph import NamedNode, Triple

from kg.render.flow_picture import Box, Flow, draw_flow
from kg.rules.authoring.spelling import common_prefixes, spell_term
from kg.rules.dependencies import Read, depends, reads
from kg.rules.form import Atom, Rule, Variable, is_auxiliary
from kg.rules.specialise import specialise
from kg.rules.stratify import edges, stratify
from kg.syntax.names import PREFIXES, RDF_TYPE

if TYPE_CHECKING:
    from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence

    from kg.rules.files import RuleFile

_ANY_PROPERTY: Final = "any property"
_ANY_CLASS: Final = "any class"


@dataclass(frozen=True, slots=True)
class RuleNode:
    """The rules of one file: the strata in which they run, and whether one feeds itself."""

    name: str
    title: str
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
    """Rules with the terms passed between them; True if the reader tests the absence or number of a term."""

    rules: tuple[RuleNode, ...]
    terms: tuple[str, ...]
    derives: Mapping[tuple[str, str], None]
    reads: Mapping[tuple[str, str], bool]

    def fed_by(self, name: str) -> list[str]:
        """Return the other rules that derive terms a rule reads."""
        terms = {term for term, reader in self.reads if reader == name}
        return sorted({writer for writer, term in self.derives if term in terms} - {name})

    def feeds(self, name: str) -> list[str]:
        """Return the other rules that read terms a rule derives."""
        terms = {term for writer, term in self.derives if writer == name}
        return sorted({reader for term, reader in self.reads if term in terms} - {name})

    def around(self, names: Collection[str]) -> RuleGraph:
        """Return these rules, the rules that feed them, those that they feed, and the terms passed between them."""
        read = {term for term, reader in self.reads if reader in names}
        derived = {term for writer, term in self.derives if writer in names}
        derives = {pair: None for pair in self.derives if pair[0] in names or pair[1] in read}
        reads = {pair: absent for pair, absent in self.reads.items() if pair[1] in names or pair[0] in derived}
        selected = {*names, *(writer for writer, _ in derives), *(reader for _, reader in reads)}
        return RuleGraph(
            tuple(node for node in self.rules if node.name in selected),
            tuple(term for term in self.terms if term in read | derived),
            derives,
            reads,
        )


def rule_graph(files: Sequence[RuleFile], schema: Iterable[Triple] = ()) -> RuleGraph:
    """Return the dependencies of rules, those over any schema cut to `schema`.

    Raises RuleError: KG202 and KG204 where they have no strata.
    """
    prefixes = common_prefixes(files)
    rules = specialise((rule for file in files for rule in file.rules), schema)
    derives: dict[tuple[str, str], None] = {}
    readers: dict[tuple[str, str], bool] = {}
    for reader, needs in zip(rules, edges(rules), strict=True):
        read_by = tuple(reads(reader))
        for number in needs:
            writer = rules[number]
            for head, read in _joined(writer, read_by):
                auxiliary = is_auxiliary(head.predicate)
                term = f"steps of {writer.name}" if auxiliary else _passed(head, read.atom, prefixes)
                derives[writer.name, term] = None
                readers[term, reader.name] = readers.get((term, reader.name), False) or read.negated
    return RuleGraph(_nodes(files, rules), tuple(sorted({term for _, term in derives})), derives, readers)


def _nodes(files: Sequence[RuleFile], rules: Sequence[Rule]) -> tuple[RuleNode, ...]:
    """Return a node for each file, with the strata of all its rules."""
    titles = {file.name: file.documentation.title for file in files}
    where = {id(rule): stratum for stratum in stratify(rules) for rule in stratum.rules}
    members: dict[str, list[int]] = defaultdict(list)
    for number, rule in enumerate(rules):
        members[rule.name].append(number)
    nodes = []
    for name, numbers in members.items():
        strata = [where[id(rules[number])] for number in numbers]
        ran = tuple(sorted({stratum.level for stratum in strata}))
        recursive = any(stratum.recursive for stratum in strata)
        nodes.append(RuleNode(name, titles[name], ran, recursive))
    return tuple(sorted(nodes, key=lambda node: node.name))


def _joined(writer: Rule, read_by: Sequence[Read]) -> Iterator[tuple[Atom, Read]]:
    """Yield the heads of a rule that another rule reads, with what that rule reads."""
    for head in writer.head:
        for read in read_by:
            # Most pairs differ in the predicate, which is far cheaper to test than the whole atom.
            predicates = (read.atom.predicate, head.predicate)
            same = predicates[0] == predicates[1] or not all(isinstance(one, NamedNode) for one in predicates)
            if same and depends(read.atom, head):
                yield head, read


def _passed(head: Atom, read: Atom, prefixes: Mapping[str, str]) -> str:
    """Return the term passed: the derived one, or its kind if the reader takes any of that kind."""
    if isinstance(read.predicate, Variable):
        return _ANY_PROPERTY
    open_class = read.predicate == RDF_TYPE and isinstance(read.object, Variable)
    return _ANY_CLASS if open_class else spell_atom(head, prefixes)


def spell_atom(atom: Atom, prefixes: Mapping[str, str] = PREFIXES) -> str:
    """Return the property of an atom, or for a type its class."""
    if not isinstance(atom.predicate, NamedNode):
        return _ANY_PROPERTY
    if atom.predicate == RDF_TYPE:
        return f"a {spell_term(atom.object, prefixes)}" if isinstance(atom.object, NamedNode) else _ANY_CLASS
    return spell_term(atom.predicate, prefixes)


def graph_picture(graph: RuleGraph, title: str) -> str:
    """Return the graph as SVG."""
    boxes = []
    for node in graph.rules:
        recursive = ", feeds itself" if node.recursive else ""
        about = f"{node.name}: {node.title} ({node.when}{recursive})"
        boxes.append(Box(node.name, node.name.rpartition("/")[2], node.family, about, node.when))
    boxes += [Box(f"={term}", term) for term in graph.terms]
    flows = [Flow(key, f"={term}") for key, term in graph.derives]
    flows += [Flow(f"={term}", key, absent=absent) for (term, key), absent in graph.reads.items()]
    return draw_flow(title, boxes, flows)


def mermaid(graph: RuleGraph) -> str:
    """Return the graph as a Mermaid flowchart."""
    keys = {node.name: f"r{number}" for number, node in enumerate(graph.rules)}
    terms = {name: f"t{number}" for number, name in enumerate(graph.terms)}
    lines = ["flowchart LR"]
    for number, family in enumerate(sorted({node.family for node in graph.rules})):
        lines.append(f'  subgraph f{number} ["{_quoted(family)}"]')
        members = (node for node in graph.rules if node.family == family)
        lines += [f'    {keys[node.name]}["{_quoted(node.name)}<br/>{node.when}"]' for node in members]
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
    """Yield a plain object for each rule: the terms it derives for others, and which rules it reads by which term."""
    writers: dict[str, set[str]] = defaultdict(set)
    for name, term in graph.derives:
        writers[term].add(name)
    for node in graph.rules:
        yield {
            "rule": node.name,
            "title": node.title,
            "strata": list(node.strata),
            "recursive": node.recursive,
            "derives": sorted(term for name, term in graph.derives if name == node.name),
            "reads": [
                {"term": term, "negated": absent, "rules": sorted(writers[term])}
                for (term, name), absent in sorted(graph.reads.items())
                if name == node.name
            ],
        }
