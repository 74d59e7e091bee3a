"""Rules: by family with their documentation, their dependencies, the last run; and details of one.

The view `rule_index` parses only the rules that it returns; `rules` parses all and computes their dependencies.
"""

from __future__ import annotations

from collections import defaultdict
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Final, TypeAlias

from pyoxigraph import NamedNode

from kg.errors import RuleError, UnknownNameError
from kg.graph.vocabulary import RNKG
from kg.pipeline.inferring import last_run
from kg.pipeline.reasoning import digest, explained_vocabulary, ontology_schema, rule_folders, rules_in_force
from kg.rules.authoring.graph import RuleGraph, rule_graph
from kg.rules.authoring.library import Entry, Library
from kg.rules.authoring.manual import documentation, documented, entry_object, manual, manual_object
from kg.rules.authoring.starting import find_rule
from kg.rules.explain.view import View
from kg.rules.files import Documentation, RuleFile
from kg.rules.form import is_auxiliary
from kg.rules.recording import Names
from kg.similar import did_you_mean
from kg.store.opening import layout_of
from kg.syntax.names import PREFIXES, shorten
from kg.views.evidence import Places

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Mapping
    from pathlib import Path

    from kg.settings import Settings
    from kg.store.interface import Queryable
    from kg.store.snapshot import EmbeddedSnapshot

_SAMPLE: Final = 20
_HEADS: Final = 12  # so many kinds of triples that a rule derives are looked up
_RUN: Final = f"""SELECT ?run ?started ?ended ?inferred {{
  ?run a <{RNKG}RuleRun> ; prov:startedAtTime ?started ; prov:endedAtTime ?ended ; <{RNKG}inferredCount> ?inferred
}} ORDER BY DESC(?started) LIMIT 1"""
_PREFIXES: Final = {**PREFIXES, "prov": "http://www.w3.org/ns/prov#"}


@dataclass(frozen=True, slots=True)
class _Available:
    """The available rules, their dependencies, and their problems."""

    library: Library
    graph: RuleGraph
    errors: tuple[RuleError, ...]


_Key: TypeAlias = "tuple[str, tuple[Path, ...]]"
"""The digest of rules, and their folders, of which several may have equal files."""
_LIBRARIES: Final[dict[_Key, Library]] = {}  # what was listed last
_LAST: Final[dict[_Key, _Available]] = {}  # what was read last


def _load(settings: Settings, mark: str) -> _Available:
    """Return the rules of the settings; they are read again when the digest of their files is another."""
    key = mark, rule_folders(settings)
    if key not in _LAST:
        library = listed(settings, mark)
        files, errors = library.read_all()
        try:
            graph = rule_graph(files, ontology_schema(settings))
        except RuleError as error:
            graph, errors = RuleGraph((), (), {}, {}), [*errors, error]
        _LAST.clear()
        _LAST[key] = _Available(library, graph, tuple(errors))
    return _LAST[key]


def listed(settings: Settings, mark: str) -> Library:
    """Return the rules of the settings, of which few need to be parsed; `mark` is the digest of their files."""
    key = mark, rule_folders(settings)
    if key not in _LIBRARIES:
        library = Library.of(settings)
        _LIBRARIES.clear()
        _LIBRARIES[key] = library
    return _LIBRARIES[key]


def rules(snapshot: EmbeddedSnapshot, settings: Settings) -> dict[str, Any]:
    """Return all rules.

    `families` lists `family`, `in_force` (whether any of it is) and its `rules`: objects as of `kg rules list --json`
    with `sections` (heading to text, as `kg rules show` prints them) and, of the last run of all rules, `seconds`,
    `derived` (triples that it was the first to derive) and `rounds`; these are None where that is not known. `graph`
    has `nodes` (`rule`, `title`, `family`, `strata`, `recursive`) and `edges` (`from`, `to`, `terms`, `absent`: whether
    the reader asks for what is not there). `run` is None or has `started`, `ended`, `inferred`, `asserted`, `seconds`
    (of all rules), `fired` and `ran` (how many rules derived something, and how many there were). `problems` are
    errors as texts.
    """
    available = _load(settings, digest(settings))
    library, costs = available.library, costs_of(settings)
    families: dict[str, list[dict[str, Any]]] = defaultdict(list)
    for entry in library.entries.values():
        families[entry.family].append(rule_object(library, entry, costs))
    return {
        "families": [
            {"family": name, "in_force": any(one["in_force"] for one in entries), "rules": entries}
            for name, entries in sorted(families.items())
        ],
        "graph": _graph_object(available.graph),
        "run": run_object(snapshot, settings, costs, len(library.in_force)),
        "problems": problem_texts(available.errors),
    }


def rule_feeds(snapshot: EmbeddedSnapshot, settings: Settings) -> dict[str, Any]:
    """Return which rules feed which: the `graph` and the `problems` of `rules`."""
    del snapshot
    available = _load(settings, digest(settings))
    return {"graph": _graph_object(available.graph), "problems": problem_texts(available.errors)}


def problem_texts(errors: Iterable[RuleError]) -> list[str]:
    """Return errors as texts with code and place."""
    return [f"{error.code}: {error.message} ({error.place})" for error in errors]


def rule(snapshot: EmbeddedSnapshot, settings: Settings, name: str) -> dict[str, Any]:
    """Return details of one rule: the object of `kg rules show --json`, with these keys in addition.

    `place` and `examples_place` are places of `kg.views.evidence`; `seconds`, `derived` and `rounds` are as in `rules`.
    `around` is the graph of the rule with those that feed it and that it feeds. `inferred` is a sample of inferred
    triples of the kinds that it derives, as `subject`, `predicate`, `object` (each in the syntax of N-Triples) with
    `labels` (as people read the three); other rules may give them too. `found` counts the inferred triples of each
    kind that it derives. `problem` is the error of the rules, or None.

    Raises:
        UnknownNameError: KG001 with suggestions.
        RuleError: KG2xx for a rule that cannot be read.
    """
    every = _load(settings, digest(settings))
    entry = find_rule(every.library, name)
    described = manual(every.library, entry, ontology_schema(settings), every.graph)
    problem = next(iter((described.problem, *every.errors)), None)
    heads, kinds = _heads(described.file), []
    for kind, pattern in heads.items():
        query = f"SELECT (COUNT(*) AS ?n) {{ GRAPH {_inferred(settings)} {{ {pattern} }} }}"
        kinds.append({"kind": kind, "triples": int(next(_rows(snapshot, query))["n"].value)})
    return {
        **manual_object(entry, described),
        **_cost(entry.name, costs_of(settings)),
        "place": _place(entry, entry.path),
        "examples_place": _place(entry, entry.examples) if entry.examples.is_file() else None,
        "around": _graph_object(every.graph.around({entry.name})),
        "found": kinds,
        "inferred": list(_sample(snapshot, settings, heads)),
        "problem": f"{problem.code}: {problem.message}" if problem else None,
    }


def _place(entry: Entry, path: Path) -> dict[str, Any]:
    """Return the place of a file of a rule, by the name that is shown."""
    return {**Places.own(path, 1), "path": f"{entry.name}{path.suffix}"}


def rule_object(library: Library, entry: Entry, costs: Mapping[str, Any]) -> dict[str, Any]:
    """Return a rule in a list, with its `sections`, its cost, and the error that it cannot be read."""
    described, error = documented(library, entry)
    return {**entry_object(entry, described, error), "sections": dict(described.sections), **_cost(entry.name, costs)}


def costs_of(settings: Settings) -> Mapping[str, Any]:
    """Return seconds, derived triples and rounds of each rule in the last run of all; empty if not known."""
    run = last_run(layout_of(settings).cache)
    return run.costs if run else {}


def _cost(name: str, costs: Mapping[str, Any]) -> dict[str, Any]:
    seconds, derived, rounds = costs.get(name, (None, None, None))
    return {"seconds": seconds, "derived": derived, "rounds": rounds}


def run_object(
    snapshot: EmbeddedSnapshot, settings: Settings, costs: Mapping[str, Any], in_force: int
) -> dict[str, Any] | None:
    """Return the record of the last run; None if rules never ran."""
    row = next(_rows(snapshot, _RUN), None)
    if row is None:
        return None
    last = last_run(layout_of(settings).cache)
    return {
        "started": row["started"].value,
        "ended": row["ended"].value,
        "inferred": last.inferred if last else int(row["inferred"].value),
        "asserted": last.asserted if last else None,
        "seconds": sum(seconds for seconds, _, _ in costs.values()) if costs else None,
        "fired": sum(1 for _, derived, _ in costs.values() if derived) if costs else None,
        "ran": in_force,
    }


def _graph_object(graph: RuleGraph) -> dict[str, Any]:
    edges: dict[tuple[str, str], dict[str, Any]] = {}
    writers: dict[str, list[str]] = defaultdict(list)
    for name, term in graph.derives:
        writers[term].append(name)
    for (term, reader), absent in graph.reads.items():
        for writer in writers[term]:
            edge = edges.setdefault((writer, reader), {"terms": [], "absent": False})
            edge["terms"].append(term)
            edge["absent"] = edge["absent"] or absent
    return {
        "nodes": [
            {
                "rule": node.name,
                "title": node.title,
                "family": node.family,
                "strata": list(node.strata),
                "recursive": node.recursive,
            }
            for node in graph.rules
        ],
        "edges": [{"from": one, "to": other, **edge} for (one, other), edge in sorted(edges.items())],
    }


def _heads(file: RuleFile) -> dict[str, str]:
    """Return the kinds of triples that a rule derives, spelt, each with the pattern that matches them."""
    patterns: dict[str, str] = {}
    for atom in (atom for one in file.rules for atom in one.head):
        if isinstance(atom.predicate, NamedNode) and not is_auxiliary(atom.predicate):
            kind, what = shorten(atom.predicate.value), atom.object
            pattern = f"?s {atom.predicate} ?o . BIND({atom.predicate} AS ?p)"
            if kind == "rdf:type" and isinstance(what, NamedNode):
                kind = f"a {shorten(what.value)}"
                pattern = f"?s {atom.predicate} {what} . BIND({atom.predicate} AS ?p) BIND({what} AS ?o)"
            patterns.setdefault(kind, pattern)
    return dict(list(patterns.items())[:_HEADS])


def _inferred(settings: Settings) -> NamedNode:
    return Names.of(settings.base, RNKG).inferred


def _sample(snapshot: EmbeddedSnapshot, settings: Settings, heads: Mapping[str, str]) -> Iterator[dict[str, Any]]:
    """Yield some inferred triples, as many of each kind."""
    each = max(1, _SAMPLE // max(1, len(heads)))
    view = View(snapshot, explained_vocabulary(settings))
    for pattern in heads.values():
        query = f"SELECT ?s ?p ?o {{ GRAPH {_inferred(settings)} {{ {pattern} }} }} LIMIT {each}"
        for row in _rows(snapshot, query):
            terms = (row["s"], row["p"], row["o"])
            yield {
                **dict(zip(("subject", "predicate", "object"), map(str, terms), strict=True)),
                "labels": [view.label(terms[0]), view.spelt(terms[1]), view.label(terms[2])],
            }


def _rows(graph: Queryable, query: str) -> Iterator[Any]:
    return iter(graph.query(query, prefixes=_PREFIXES))


OWN: Final = "own"
"""Name of the family of rules that are in no folder of their own."""


def rule_index(snapshot: EmbeddedSnapshot, settings: Settings, family: str = "", text: str = "") -> dict[str, Any]:
    """Return the families of rules with counts, and the rules of a family that contain all words of `text`.

    `families` lists `family`, `in_force` (whether any rule of it is), and the number of its `rules`, of those that
    `run` and that `report` findings; of the last run of all rules, `fired` (how many derived something), `derived` and
    `seconds`, which are None where that is not known. `rules` are objects as in the view `rules`, without `sections`;
    there are none without `family` and `text`. Words are searched in names, titles and documentation. `all` is the
    number of all rules; `run` is as in the view `rules`. `problems` are errors of rules that cannot be read, as texts.

    Raises UnknownNameError: KG001 with suggestions, for a family that does not exist.
    """
    mark = digest(settings)
    library, costs = listed(settings, mark), costs_of(settings)
    families: dict[str, list[Entry]] = defaultdict(list)
    for entry in library.entries.values():
        families[entry.family or OWN].append(entry)
    if family and family not in families:
        hint = did_you_mean(family, families) or f"Families: {', '.join(sorted(families))}."
        raise UnknownNameError("KG001", f"unknown family of rules `{family}`", hint=hint)
    texts = {entry.name: _documentation(entry) for entry in library.entries.values()}
    chosen = [*families[family]] if family else [*library.entries.values()] if text else []
    words = text.lower().split()
    shown = [entry for entry in chosen if _contains(entry, texts[entry.name], words)]
    broken = list(library.problems)
    rules_in_force(settings, broken, cache=layout_of(settings).cache)
    return {
        "families": [_family(name, members, texts, costs) for name, members in sorted(families.items())],
        "rules": [
            {key: value for key, value in rule_object(library, entry, costs).items() if key != "sections"}
            for entry in shown
        ],
        "all": len(library.entries),
        "run": run_object(snapshot, settings, costs, len(library.in_force)),
        "problems": list(dict.fromkeys(problem_texts(broken))),
    }


def _documentation(entry: Entry) -> Documentation:
    """Return the documentation of a rule; empty where it cannot be read."""
    try:
        return documentation(entry)
    except RuleError:
        return Documentation()


def _contains(entry: Entry, documented: Documentation, words: Iterable[str]) -> bool:
    """Return whether the name, title and documentation of a rule contain all words, in lower case."""
    text = " ".join((entry.name, documented.title, *documented.sections.values())).lower()
    return all(word in text for word in words)


def _family(
    name: str, entries: list[Entry], texts: Mapping[str, Documentation], costs: Mapping[str, Any]
) -> dict[str, Any]:
    measured = [costs[entry.name] for entry in entries if entry.name in costs]
    return {
        "family": name,
        "in_force": any(entry.in_force for entry in entries),
        "rules": len(entries),
        "run": sum(entry.in_force for entry in entries),
        "report": sum(bool(texts[entry.name].severity) for entry in entries),
        "fired": sum(1 for _, derived, _ in measured if derived) if measured else None,
        "derived": sum(derived for _, derived, _ in measured) if measured else None,
        "seconds": sum(seconds for seconds, _, _ in measured) if measured else None,
    }
