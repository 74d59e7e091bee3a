"""Reading of systems from the store, the inverse of `kg.graph.systems`; a test compares the two.

Not stored are the arguments given to a configuration, the files that it read, and the lines of includes.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import partial
from types import MappingProxyType
from typing import TYPE_CHECKING, Final, TypeAlias

from pyoxigraph import NamedNode

from kg import facts
from kg.graph import vocabulary as v
from kg.graph.chains import chain_of, likely_chain
from kg.graph.fields import ARGUMENT, PROBLEM, SETTING, Properties, one, place_of, word
from kg.graph.iris import RUNNING, Iris
from kg.graph.reading.nodes import (
    code_facts,
    end_of,
    qualities,
    references,
    these,
    type_of,
)
from kg.graph.reading.queries import Texts, among, one_of, properties_in, texts
from kg.graph.starts import STARTS
from kg.graph.usual_ends import UsualEnd, namespace_of, usual_ends, usual_resolution

if TYPE_CHECKING:
    from collections.abc import Collection, Iterable, Iterator, Mapping

    from kg.store.interface import Queryable


_Content: TypeAlias = "dict[str, dict[str, list[str]]]"
"""Properties of things, by their IRIs and those of properties."""

_NAMES: Final = """
SELECT ?name ?path ?ros ?repository WHERE {
  GRAPH ?launch {
    %s
    ?configuration rnkg:launchDialect ?dialect ; rnkg:ofPackage ?package ; rnkg:name ?name ; rnkg:path ?path ;
                   rnkg:rosVersion ?ros .
  }
  GRAPH ?source { ?owner rnkg:contains ?package ; rnkg:name ?repository }
}"""
_RUNNING: Final = """
SELECT ?name ?path ?ros WHERE {
  %s
  ?configuration a rnkg:RunningSystem ; rnkg:name ?name ; rnkg:path ?path ; rnkg:rosVersion ?ros .
}"""
_INCLUDED: Final = "SELECT DISTINCT ?one ?name WHERE { ?other rnkg:includes ?one . ?one rnkg:name ?name }"
_STARTED: Final = """
SELECT DISTINCT ?name ?system WHERE {
  %s
  ?configuration rnkg:hasInstance/rnkg:name ?name ; rnkg:name ?system .
}"""
_TYPES: Final = """
SELECT DISTINCT ?package ?type WHERE {
  %s
  ?configuration rnkg:hasInstance ?instance . ?instance rnkg:name ?name ; rnkg:instanceOf ?node .
  ?node rnkg:name ?type . ?in rnkg:contains ?node ; rnkg:name ?package .
}"""
_NO_LABELS: Final[Mapping[str, str]] = MappingProxyType({})
_GRAPH: Final = "SELECT ?s ?p ?o WHERE { GRAPH <%s> { ?s ?p ?o } }"
_STARTS: Final = """
SELECT DISTINCT ?s ?p ?o WHERE { GRAPH <%s> { ?instance rnkg:startedWith ?s } GRAPH ?starts { ?s ?p ?o } }"""
_STARTED_PARTS: Final = """
SELECT DISTINCT ?s ?p ?o WHERE {
  GRAPH <%s> { ?instance rnkg:startedWith ?start }
  GRAPH ?starts { ?start rnkg:hasSetting|rnkg:readsEntry|rnkg:hasRemap ?s . ?s ?p ?o }
}"""
_PARTS: Final = """
SELECT DISTINCT ?graph ?configuration ?instance ?part WHERE {
  %s GRAPH ?graph { ?configuration rnkg:hasInstance ?instance }
}"""
_LAUNCHES: Final = """
SELECT ?graph ?configuration ?relation ?part WHERE {
  VALUES (?graph ?configuration) { %s }
  VALUES ?relation { rnkg:hasArgument rnkg:includes }
  GRAPH ?graph { ?configuration ?relation ?part }
}"""
_OF: Final = """
SELECT ?subject ?predicate ?object WHERE {
  VALUES (?graph ?subject) { %s }
  GRAPH ?graph { ?subject ?predicate ?object }
  FILTER(?predicate NOT IN (
    rnkg:hasInstance, ros:hasComponent, rnkg:hasSetting, rnkg:readsEntry, rnkg:hasRemap, rnkg:host,
    rnkg:includes, rnkg:hasArgument, rnkg:hasLaunchProblem, rnkg:resembles
  ))
}"""


@dataclass(frozen=True, slots=True, order=True)
class SystemName:
    """What names a configuration: its source and path, and the `name` that people use.

    The source of a running system is `kg.graph.iris.RUNNING`, its path the name that it was given.
    """

    repository: str
    path: str
    name: str
    ros: int


def system_names(
    graph: Queryable, iris: Collection[str] | None = None, named: Collection[str] | None = None
) -> list[SystemName]:
    """Return the configurations of the store, sorted by source and path, those of running systems too.

    With `iris` or `named` only those of these IRIs or names.
    """
    those = "" if iris is None else among("configuration", iris)
    if named is not None:
        those += f" {one_of('name', named)}"
    rows = (*texts(graph, _NAMES % those), *((*row, RUNNING) for row in texts(graph, _RUNNING % those)))
    return sorted(SystemName(repository, path, name, int(ros)) for name, path, ros, repository in rows)


def included(graph: Queryable, labels: Mapping[str, str] = _NO_LABELS) -> frozenset[str]:
    """Return the names of the configurations that others include; `labels` has other names for some of their IRIs."""
    return frozenset(labels.get(iri, name) for iri, name in texts(graph, _INCLUDED))


def started_names(graph: Queryable, name: str | None = None) -> dict[str, list[str]]:
    """Return the absolute names of instances, each with the configurations that start it, sorted; or one `name`."""
    by_name: dict[str, set[str]] = {}
    for instance, system in texts(graph, _STARTED % ("" if name is None else one_of("name", [name]))):
        by_name.setdefault(instance, set()).add(system)
    return {name: sorted(by_name[name]) for name in sorted(by_name)}


def started_types(graph: Queryable, name: str) -> list[str]:
    """Return the node types of the instances with an absolute name, as `package/node`, sorted."""
    return sorted(map("/".join, texts(graph, _TYPES % one_of("name", [name]))))


def systems(graph: Queryable, names: Iterable[SystemName], base: str) -> list[facts.System]:
    """Return the systems of these names, in their order; `base` is that of the IRIs of the store."""
    iris = Iris(base)
    content = partial(_content, graph)
    if isinstance(graph, Texts):
        content = partial(_read, graph, graph.properties(iris.graph(STARTS)))
    contents = [(name, content(iris.system_graph(name.repository, name.path))) for name in names]
    records = _Records(graph, [content for _, content in contents])
    return [_Reading(name, content, records, iris).run() for name, content in contents]


def partial_systems(  # noqa: PLR0913 - the parts of systems
    graph: Queryable,
    names: Iterable[SystemName] | None,
    parts: Iterable[tuple[str, str]],
    base: str,
    usual: Collection[UsualEnd] = (),
    *,
    launches: bool = False,
) -> list[facts.System]:
    """Return the systems of these names (None: of any) that have some `parts`, with these and their instances alone.

    `parts` are relations, each with a pattern that binds the ?part of an ?instance, and the ?graph of that. Settings
    belong to what the instance is started with. `usual` are ends that are not stated. What named an end is there as
    well; other parameters and remappings, and what is said of a system as a whole, are not. With `launches` all systems
    are there, with their arguments and includes.
    """
    iris = Iris(base)
    rows = [(*row, v.bare(relation)) for relation, pattern in parts for row in texts(graph, _PARTS % pattern)]
    if names is None:
        names = system_names(graph, {row[1] for row in rows} | {end.system for end in usual})
    by_iri = {iris.configuration(one.repository, one.path): one for one in names}
    rows = [row for row in rows if row[1] in by_iri]
    graphs = {iri: iris.system_graph(name.repository, name.path) for iri, name in by_iri.items()}
    unstated = [end for end in usual if end.system in by_iri]
    chosen_parts = {(row[0], part) for row in rows for part in row[1:-1]}
    chosen_parts |= {(graphs[end.system], part) for end in unstated for part in (end.system, end.instance)}
    wholes = {(graphs[iri], iri) for iri in by_iri} if launches else set()
    relations = list(texts(graph, _LAUNCHES % _pairs(wholes)))
    content = _properties(graph, iris, chosen_parts | wholes | {(where, part) for where, _, _, part in relations})
    for _, configuration, relation, part in relations:
        _add(content[configuration], relation, part)
    chosen: dict[str, set[str]] = {}
    for end in unstated:
        _add(content[end.system], v.bare(v.HAS_INSTANCE), end.instance)
        chosen.setdefault(end.instance, set()).add(end.code)
    settings = v.bare(v.HAS_SETTING)
    for _, configuration, instance, part, relation in rows:
        _add(content[configuration], v.bare(v.HAS_INSTANCE), instance)
        if relation != settings:
            _add(content[instance], relation, part)
    leads = [v.bare(term) for term in (v.CONNECTS_TO, v.REMAPPED_BY, v.NAMED_BY, v.STARTED_WITH)]
    led = {
        (where, iri) for where, part in chosen_parts for term in leads for iri in content.get(part, {}).get(term, ())
    }
    content |= _properties(graph, iris, {(where, iri) for where, iri in led if iri not in content})
    for _, _, instance, part, relation in rows:
        start, remap = one(content[instance], v.STARTED_WITH), one(content.get(part, {}), v.REMAPPED_BY)
        if start and remap:
            _add(content[start], v.bare(v.HAS_REMAP), remap)
        if start and relation == settings:
            _add(content[start], settings, part)
    terms = (v.bare(v.DECLARED_BY), v.bare(v.OVERRIDES), v.bare(v.SETS))
    declared = {iri for properties in content.values() for term in terms for iri in properties.get(term, ())}
    declared |= {end.code for end in unstated}
    records = _Records(graph, [content], among("subject", declared))
    having = {row[1] for row in rows} | {end.system for end in unstated} | {iri for _, iri in wholes}
    return [_Reading(name, content, records, iris, chosen).run() for iri, name in by_iri.items() if iri in having]


def _add(properties: dict[str, list[str]], term: str, value: str) -> None:
    values = properties.setdefault(term, [])
    if value not in values:
        values.append(value)


def _properties(graph: Queryable, iris: Iris, parts: Iterable[tuple[str, str]]) -> dict[str, dict[str, list[str]]]:
    """Return what graphs say of parts of systems, but for what leads on to others.

    What instances are started with has a graph of its own.
    """
    starts, start = iris.graph(STARTS), f"{iris.base}start/"
    placed = {(starts if part.startswith(start) else where, part) for where, part in parts}
    return properties_in(graph, _OF % _pairs(placed))


def _pairs(parts: Iterable[tuple[str, str]]) -> str:
    return " ".join(f"({NamedNode(where)} {NamedNode(part)})" for where, part in sorted(parts))


def _content(graph: Queryable, name: str) -> _Content:
    return {
        iri: properties
        for query in (_GRAPH, _STARTS, _STARTED_PARTS)
        for iri, properties in properties_in(graph, query % name).items()
    }


def _read(graph: Texts, starts: _Content, name: str) -> _Content:
    """Return what `_content` does, with all that instances are started with at hand."""
    content = dict(graph.properties(name))
    for terms in ((v.STARTED_WITH,), (v.HAS_SETTING, v.READS_ENTRY, v.HAS_REMAP)):
        led = {iri for own in content.values() for term in terms for iri in own.get(v.bare(term), ())}
        content |= {iri: starts[iri] for iri in led if iri in starts}
    return content


class _Records:
    """The node types of instances, with their references."""

    def __init__(
        self, graph: Queryable, contents: Iterable[Mapping[str, Properties]], declared: str | None = None
    ) -> None:
        """Read the node types of instances; `declared` is a pattern for ?subject, where not all they declare counts."""
        types = {
            iri
            for content in contents
            for properties in content.values()
            for term in (v.INSTANCE_OF, v.LOADS_PLUGIN)
            for iri in properties.get(v.bare(term), ())
        }
        every = f"{these(graph, 'owner', types)} ?owner ros:hasComponent|rnkg:hasParameter ?subject ."
        facts_by_iri = code_facts(graph, declared or every) if types else {}
        self._by_iri = references(graph, types) if types else {}
        self.ends = {
            iri: (owner, fact) for iri, (owner, fact) in facts_by_iri.items() if isinstance(fact, facts.Interface)
        }
        self.usual: dict[facts.NodeReference, dict[str, facts.Interface]] = {}
        """The ends that frameworks make, by node type and IRI."""
        for iri, (owner, fact) in self.ends.items():
            if fact.implicit:
                self.usual.setdefault(owner, {})[iri] = fact
        self.settable = {
            iri: (owner, fact) for iri, (owner, fact) in facts_by_iri.items() if isinstance(fact, facts.Parameter)
        }
        self.qualities: Mapping[str, facts.Qos] = qualities(graph) if types else {}

    def reference(self, iri: str | None) -> facts.NodeReference | None:
        """Return the reference of the node type with an IRI."""
        return self._by_iri.get(iri) if iri else None


class _Reading:
    """One system on its way back."""

    def __init__(
        self,
        name: SystemName,
        content: Mapping[str, Properties],
        records: _Records,
        iris: Iris,
        chosen: Mapping[str, Collection[str]] | None = None,
    ) -> None:
        """Read all ends; with `chosen` only those that are stated, and of the usual ones of an instance these."""
        self._name = name
        self._chosen = chosen
        self._content = content
        self._records = records
        self._iris = iris
        self._iri = iris.configuration(name.repository, name.path)

    def run(self) -> facts.System:
        own = self._content[self._iri]
        instances = sorted(own.get(v.bare(v.HAS_INSTANCE), ()), key=self._order)
        shared = tuple(self._setting(iri) for iri in self._listed(own, v.HAS_SETTING))
        return facts.System(
            configuration=self._configuration(own),
            instances=tuple(map(self._instance, instances)),
            similar=self._similar(),
            shared_parameters=shared,
            sighting=_sighting(own),
        )

    def _order(self, iri: str) -> tuple[int, str]:
        return int(one(self._content[iri], v.ORDER) or 0), iri

    def _listed(self, properties: Properties, term: str) -> list[str]:
        return sorted(properties.get(v.bare(term), ()), key=self._order)

    def _configuration(self, own: Properties) -> facts.LaunchConfiguration:
        path, name = self._name.path, self._name.name
        package, _, inner = name.partition("/")
        folder = path.removesuffix(inner).rstrip("/") if path.endswith(inner) else ""
        problems = sorted(map(self._problem, own.get(v.bare(v.HAS_LAUNCH_PROBLEM), ())), key=repr)
        arguments = sorted(map(self._argument, own.get(v.bare(v.HAS_ARGUMENT), ())), key=_argument_order)
        return facts.LaunchConfiguration(
            repository=self._name.repository,
            package=package,
            path=path,
            ros=self._name.ros,
            dialect=facts.LaunchDialect(one(own, v.LAUNCH_DIALECT) or ""),
            arguments=tuple(arguments),
            nodes=(),
            includes=tuple(map(self._include, sorted(own.get(v.bare(v.INCLUDES), ())))),
            problems=tuple(problems),
            folder=folder or ".",
        )

    def _include(self, iri: str) -> facts.LaunchInclude:
        thing = self._iris.parse(iri)
        repository, path = thing.parts if thing else ("", iri)
        return facts.LaunchInclude(path, facts.Location(self._name.path, 0), (), repository, path)

    def _problem(self, iri: str) -> facts.LaunchProblem:
        properties = self._content[iri]
        location, chain = _place(properties)
        return facts.LaunchProblem(location=location, chain=chain, **PROBLEM.read(properties))

    def _argument(self, iri: str) -> facts.LaunchArgument:
        properties = self._content[iri]
        return facts.LaunchArgument(location=_place(properties)[0], **ARGUMENT.read(properties))

    def _setting(self, iri: str, led: tuple[facts.Location, ...] = ()) -> facts.LaunchParameter:
        properties = self._content[iri]
        location, chain = _place(properties, led)
        name = one(properties, v.NAME) or ""
        return facts.LaunchParameter(name, location=location, chain=chain, **SETTING.read(properties))

    def _instance(self, iri: str) -> facts.NodeInstance:
        own, records = self._content[iri], self._records
        start = self._content.get(one(own, v.STARTED_WITH) or "", {})
        chain = chain_of(one(own, v.INCLUDE_CHAIN))
        settings = {part: self._setting(part, chain) for part in self._listed(start, v.HAS_SETTING)}
        remaps = {part: self._remap(part, chain) for part in self._listed(start, v.HAS_REMAP)}
        parts = sorted(own.get(v.bare(v.HAS_COMPONENT), ()))
        ends = [end for part in parts if (end := self._end(part, settings, remaps, chain))]
        ends += self._usual(iri, own)
        used = {end.remap for end in ends}
        host, missing = one(own, v.HOST), one(own, v.MISSING)
        plugins = (records.reference(plugin) for plugin in sorted(own.get(v.bare(v.LOADS_PLUGIN), ())))
        kind = records.reference(one(own, v.INSTANCE_OF))
        return facts.NodeInstance(
            name=one(own, v.NAME) or "",
            namespace=_namespace(own),
            started=self._started(own, start, tuple(fact.remap for fact in remaps.values())),
            type=kind,
            missing=facts.MissingType(missing) if missing else None,
            reason=one(own, v.REASON),
            plugins=tuple(plugin for plugin in plugins if plugin),
            host=one(self._content[host], v.NAME) if host else None,
            interfaces=tuple(sorted(ends, key=_end_order)),
            parameters=tuple(self._parameter(part, fact) for part, fact in settings.items()),
            remaps=tuple(
                facts.InstanceRemap(fact.source, fact.target, fact.remap, fact.remap in used, fact.similar)
                for fact in remaps.values()
            ),
            complete=one(own, v.COMPLETE) == "true",
            similar=tuple(sorted(own.get(v.bare(v.RESEMBLES_NAME), ()))),
            since=one(own, v.SEEN_SINCE),
        )

    def _started(self, own: Properties, start: Properties, remaps: tuple[facts.Remap, ...]) -> facts.StartedNode:
        location, chain = _place(own)
        pairs = (setting.partition("=") for setting in sorted(start.get(v.bare(v.START_SETTING), ())))
        return facts.StartedNode(
            name=(one(own, v.NAME) or "").rpartition("/")[2],
            namespace=_namespace(own),
            kind=facts.StartKind(one(start, v.START_KIND) or ""),
            location=location,
            chain=chain,
            package=one(start, v.STARTS_PACKAGE),
            executable=one(start, v.STARTS_EXECUTABLE),
            plugin=one(start, v.STARTS_PLUGIN),
            remaps=remaps,
            arguments=tuple((one(start, v.START_ARGUMENT) or "").split()),
            condition=one(own, v.CONDITION),
            settings=tuple((name, value) for name, _, value in pairs),
        )

    def _remap(self, iri: str, led: tuple[facts.Location, ...]) -> facts.InstanceRemap:
        own = self._content[iri]
        source, target = one(own, v.FROM) or "", one(own, v.TO) or ""
        similar = tuple(sorted(own.get(v.bare(v.RESEMBLES_NAME), ())))
        return facts.InstanceRemap(
            source, target, facts.Remap(source, target, *_place(own, led)), used=False, similar=similar
        )

    def _parameter(self, iri: str, setting: facts.LaunchParameter) -> facts.InstanceParameter:
        own = self._content[iri]
        owner, declared = self._records.settable.get(one(own, v.SETS) or "", (None, None))
        similar = tuple(sorted(own.get(v.bare(v.RESEMBLES_NAME), ())))
        return facts.InstanceParameter(setting.name, setting, declared, owner, similar)

    def _end(
        self,
        iri: str,
        settings: Mapping[str, facts.LaunchParameter],
        remaps: Mapping[str, facts.InstanceRemap],
        chain: tuple[facts.Location, ...],
    ) -> facts.InstanceInterface | None:
        """Return an end; None when the node type that declares it is not in the store any more."""
        own = self._content[iri]
        source = self._code(own) or self._seen(own) or self._foreign(own)
        if source is None:
            return None
        owner, declared = source
        remap, named, channel = (one(own, term) for term in (v.REMAPPED_BY, v.NAMED_BY, v.CONNECTS_TO))
        led = chain if (named or "").startswith(f"{self._iris.base}start/") else ()
        setting = (settings.get(named) or self._setting(named, led)) if named else None
        resolved = one(own, v.RESOLVED_NAME) or (one(self._content[channel], v.LABEL) if channel else None)
        resolution = word(own, v.RESOLUTION)
        return facts.InstanceInterface(
            declared=declared,
            owner=owner,
            resolved=resolved,
            resolution=facts.Resolution(resolution) if resolution else usual_resolution(declared, resolved, setting),
            remap=remaps[remap].remap if remap and remap in remaps else None,
            parameter=setting,
            qos=self._records.qualities.get(one(own, v.HAS_QOS) or "") if v.bare(v.TYPE) in own else declared.qos,
            reason=one(own, v.REASON),
            switches=tuple(sorted(own.get(v.bare(v.SWITCHED_BY), ()))),
        )

    def _code(self, own: Properties) -> tuple[facts.NodeReference, facts.Interface] | None:
        """Return the end of a node type that an end comes from."""
        codes = [iri for term in (v.DECLARED_BY, v.OVERRIDES) for iri in sorted(own.get(v.bare(term), ()))]
        return next((self._records.ends[iri] for iri in codes if iri in self._records.ends), None)

    def _usual(self, iri: str, own: Properties) -> Iterator[facts.InstanceInterface]:
        """Yield the ends that are not stated, for the framework gives them to every node of the type."""
        owner = self._records.reference(one(own, v.INSTANCE_OF))
        if owner is None or self._name.repository == RUNNING:
            return
        ends = self._records.usual.get(owner, {})
        usual = usual_ends(one(own, v.NAME) or "", _namespace(own), owner, ends)
        if self._chosen is not None:
            yield from (end for code, end in usual.items() if code in self._chosen.get(iri, ()))
            return
        parts = (self._content[part] for part in own.get(v.bare(v.HAS_COMPONENT), ()))
        stated = {iri for part in parts for term in (v.DECLARED_BY, v.OVERRIDES) for iri in part.get(v.bare(term), ())}
        stated.update(own.get(v.bare(v.WITHOUT), ()))
        yield from (end for code, end in usual.items() if code not in stated)

    def _seen(self, own: Properties) -> tuple[facts.NodeReference, facts.Interface] | None:
        """Return an end that was seen running, and that no code of the build declares."""
        peer = one(own, v.SEEN_AT)
        declared = self._declared(own) if peer is not None else None
        if peer is None or declared is None:
            return None
        return facts.NodeReference("", "", ""), replace(declared, location=facts.Location(peer, 0))

    def _declared(self, own: Properties) -> facts.Interface | None:
        iri = type_of(own)
        thing = self._iris.parse(iri) if iri else None
        return end_of(own, {iri: "/".join(thing.parts)} if iri and thing else {})

    def _foreign(self, own: Properties) -> tuple[facts.NodeReference, facts.Interface] | None:
        """Return what is declared by a plugin whose code is not in the build, and whose evidence the end has itself."""
        library, declared = one(own, v.LOADS_LIBRARY), self._declared(own)
        if library is None or declared is None:
            return None
        package, _, name = library.partition("/")
        owner = facts.NodeReference(declared.location.repository or self._name.repository, package, name)
        return owner, replace(declared, resolved=None, parameter=None)

    def _similar(self) -> tuple[tuple[str, str, str], ...]:
        triples = set()
        for iri, properties in self._content.items():
            for other in properties.get(v.bare(v.RESEMBLES), ()):
                kind = iri.partition("#")[2].partition("/")[0]
                first, second = sorted(one(self._content[each], v.LABEL) or "" for each in (iri, other))
                triples.add((kind, first, second))
        return tuple(sorted(triples))


def _sighting(own: Properties) -> facts.Sighting | None:
    address, since = one(own, v.ADDRESS), one(own, v.SEEN_SINCE)
    if address is None or since is None:
        return None
    return facts.Sighting(address, since, one(own, v.SEEN_UNTIL), complete=one(own, v.COMPLETE) == "true")


def _namespace(own: Properties) -> str:
    return one(own, v.NAMESPACE) or namespace_of(one(own, v.NAME) or "")


def _place(
    properties: Properties, led: tuple[facts.Location, ...] = ()
) -> tuple[facts.Location, tuple[facts.Location, ...]]:
    """Return a line and the includes that led to it; `led` are those of the instance that it concerns."""
    peer = one(properties, v.SEEN_AT)
    if peer is not None:
        return facts.Location(peer, 0), ()
    location, chain = place_of(properties), one(properties, v.INCLUDE_CHAIN)
    return location, likely_chain(location.path, led) if chain is None else chain_of(chain)


def _argument_order(argument: facts.LaunchArgument) -> tuple[str, int, str]:
    return argument.location.path, argument.location.line, argument.name


def _end_order(end: facts.InstanceInterface) -> tuple[str, str, str, str, int, str]:
    declared, location = end.declared, end.declared.location
    return str(end.owner), declared.role, end.resolved or "~~", location.path, location.line, declared.type or ""
