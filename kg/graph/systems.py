"""Systems become triples: what a launch configuration starts, under which names, and how it is wired.

The topics, services and actions of a system are its own, and so are its instances. An end of an instance states only
what differs from the end of the node type that it points to, and ends that every node has (`kg.graph.usual_ends`) are
stated where something in the system has to do with them; a system as a `whole` states everything.
"""

from __future__ import annotations

from dataclasses import replace
from datetime import datetime
from typing import TYPE_CHECKING, Final

from kg import facts
from kg.graph import vocabulary as v
from kg.graph.chains import chain_text
from kg.graph.fields import ARGUMENT, PROBLEM, SETTING
from kg.graph.interfaces import SHAPES, interface_type, quality
from kg.graph.iris import Iris, fragment
from kg.graph.ntriples import boolean, integer, literal, moment
from kg.graph.scope import Scope
from kg.graph.shared import split
from kg.graph.starts import Start
from kg.graph.usual_ends import namespace_of, usual_ends, usual_resolution
from kg.holes import is_known

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping

    from kg.graph.reading.nodes import NodeRecord

_ENDS: Final = frozenset(shape.component for shape in SHAPES.values())
"""Suffixes of the IRIs of ends, after the name of their instance."""


def system_triples(
    system: facts.System, records: Mapping[facts.NodeReference, NodeRecord], iris: Iris, *, whole: bool = False
) -> bytes:
    """Return the N-Triples of a system; `records` are the node types of its instances and their plugins.

    Triples that other graphs of a store have too, such as descriptions of types, are left out unless it is `whole`.
    """
    writing = _Writing(system, records, iris, whole=whole)
    return writing.run() if whole else writing.own(writing.run())


def system_parts(
    system: facts.System,
    records: Mapping[facts.NodeReference, NodeRecord],
    iris: Iris,
    written: Mapping[str, facts.NodeInstance],
) -> Iterator[tuple[str, facts.NodeInstance | None, bytes | None]]:
    """Yield the N-Triples of a running system part by part: together they are those of `system_triples`, as a `whole`.

    Each part is the IRI of an instance, the instance and its triples. These are None where `written` has
    the same instance for the IRI: it gave the same triples for the same records. What belongs to no instance, and a
    system with names of nodes that IRIs cannot tell from those of ends, comes without an instance.
    """
    if any(not _ENDS.isdisjoint(one.name.split("/")) for one in system.instances):
        yield "", None, system_triples(system, records, iris, whole=True)
        return
    alone = replace(system, instances=())
    yield "", None, system_triples(alone, records, iris, whole=True)
    for iri, instance in zip(_Writing(system, records, iris, whole=True).instances(), system.instances, strict=True):
        same = written.get(iri) is instance
        yield iri, instance, None if same else _Writing(alone, records, iris, whole=True).one(iri, instance)


class _Writing:
    """One system on its way into its graph."""

    def __init__(
        self, system: facts.System, records: Mapping[facts.NodeReference, NodeRecord], iris: Iris, *, whole: bool
    ) -> None:
        self._system = system
        self._whole = whole
        self._records = records
        self._scope = Scope(iris, system.configuration.repository, system.configuration.package)
        self._writer = self._scope.writer
        self._iri = iris.configuration(system.configuration.repository, system.configuration.path)
        self._subject = f"<{self._iri}>"
        self._remaps: dict[tuple[str, facts.Remap], str] = {}
        self._settings: dict[tuple[str, facts.LaunchParameter], str] = {}
        self._overrides: set[str] = set()
        self._described: set[str] = set()
        """Types that perhaps no code of the build uses."""
        self._touched: set[tuple[str, str | None]] = set() if whole else _touched(system)

    def run(self) -> bytes:
        self._configuration(self._system.configuration)
        for order, parameter in enumerate(self._system.shared_parameters):
            self._writer.add(self._subject, v.HAS_SETTING, self._setting(parameter, order))
        names: dict[str, str] = {}
        iris = self.instances()
        for iri, instance in zip(iris, self._system.instances, strict=True):
            names.setdefault(instance.name, iri)
        for order, (iri, instance) in enumerate(zip(iris, self._system.instances, strict=True)):
            self._instance(iri, instance, names, order)
        for kind, one, other in self._system.similar:
            self._writer.add(self._channel(kind, one), v.RESEMBLES, self._channel(kind, other))
            self._writer.add(self._channel(kind, other), v.RESEMBLES, self._channel(kind, one))
        return self._writer.encoded()

    def instances(self) -> list[str]:
        """Return the IRIs of the instances."""
        return [self._scope.part(self._iri, "instance", one.name.lstrip("/"))[1:-1] for one in self._system.instances]

    def one(self, iri: str, instance: facts.NodeInstance) -> bytes:
        """Return the triples of one observed instance."""
        self._instance(iri, instance, {}, 0)
        return self._writer.encoded()

    def own(self, content: bytes) -> bytes:
        """Leave out what the graph of what sources share has already, by way of the node types."""
        own, shared = split(content, self._scope.iris)
        alone = {f"{iri} " for iri in self._overrides}
        anew = tuple(
            text.encode() for text in sorted(alone | {f"{iri}{end}" for iri in self._described for end in ">#/"})
        )
        return b"".join([*own, *(line for line in shared if anew and line.startswith(anew))])

    def _configuration(self, fact: facts.LaunchConfiguration) -> None:
        writer, subject, iris = self._writer, self._subject, self._scope.iris
        writer.described(subject, fact.name, v.CONFIGURATION)
        writer.add(subject, v.ROS_VERSION, integer(fact.ros))
        writer.add(subject, v.LAUNCH_DIALECT, literal(fact.dialect))
        writer.add(subject, v.PATH, literal(fact.path))
        writer.add(subject, v.NAME, literal(fact.name))
        if self._system.sighting is not None:
            self._sighting(self._system.sighting)
            return
        writer.add(subject, v.OF_PACKAGE, f"<{iris.package(fact.repository, fact.package)}>")
        writer.add(subject, v.DECLARED_IN, f"<{iris.file(fact.repository, fact.path)}>")
        for include in fact.includes:
            if include.path is not None and include.repository is not None:
                writer.once(subject, v.INCLUDES, f"<{iris.configuration(include.repository, include.path)}>")
        for argument in fact.arguments:
            self._argument(argument)
        for problem in fact.problems:
            self._problem(problem)

    def _sighting(self, fact: facts.Sighting) -> None:
        writer, subject = self._writer, self._subject
        writer.add(subject, v.TYPE, v.RUNNING_SYSTEM)
        writer.text(subject, v.ADDRESS, fact.address)
        writer.add(subject, v.COMPLETE, boolean(fact.complete))
        writer.add(subject, v.SEEN_SINCE, moment(datetime.fromisoformat(fact.since)))
        if fact.until is not None:
            writer.add(subject, v.SEEN_UNTIL, moment(datetime.fromisoformat(fact.until)))
        for problem in self._system.configuration.problems:
            self._problem(problem, fact.since)

    def _argument(self, fact: facts.LaunchArgument) -> None:
        part, writer = self._scope.part(self._iri, "argument", fact.name), self._writer
        writer.add(self._subject, v.HAS_ARGUMENT, part)
        writer.add(part, v.TYPE, v.ARGUMENT)
        ARGUMENT.write(writer, part, fact)
        self._evidence(part, fact.location)

    def _problem(self, fact: facts.LaunchProblem, since: str | None = None) -> None:
        part, writer = self._scope.part(self._iri, "problem", fact.subject or fact.kind), self._writer
        writer.add(self._subject, v.HAS_LAUNCH_PROBLEM, part)
        writer.add(part, v.TYPE, v.LAUNCH_PROBLEM)
        PROBLEM.write(writer, part, fact)
        self._evidence(part, fact.location, fact.chain, since)

    def _instance(self, iri: str, fact: facts.NodeInstance, names: Mapping[str, str], order: int) -> None:
        subject, writer, started = f"<{iri}>", self._writer, fact.started
        writer.add(self._subject, v.HAS_INSTANCE, subject)
        writer.described(subject, fact.name, v.NODE, v.INSTANCE)
        writer.add(subject, v.NAME, literal(fact.name))
        if fact.namespace != namespace_of(fact.name):
            writer.add(subject, v.NAMESPACE, literal(fact.namespace))
        writer.add(subject, v.ROS_VERSION, integer(self._system.configuration.ros))
        if fact.since is None:
            writer.add(subject, v.ORDER, integer(order))
        writer.text(subject, v.CONDITION, started.condition)
        if started.name is None and not any(one.source == "__node" for one in started.remaps):
            writer.add(subject, v.KEEPS_OWN_NAME, boolean(value=True))
        writer.text(subject, v.MISSING, fact.missing)
        writer.text(subject, v.REASON, fact.reason)
        for name in fact.similar:
            writer.text(subject, v.RESEMBLES_NAME, name)
        writer.add(subject, v.COMPLETE, boolean(fact.complete))
        if fact.host is not None and fact.host in names:
            writer.add(subject, v.HOST, f"<{names[fact.host]}>")
        for relation, reference in ((v.INSTANCE_OF, fact.type), *((v.LOADS_PLUGIN, one) for one in fact.plugins)):
            if reference is not None and reference in self._records:
                writer.once(subject, relation, f"<{self._records[reference].iri}>")
        self._evidence(subject, started.location, started.chain, fact.since)
        self._start(iri, fact)
        for end in fact.interfaces if self._whole else self._stated_ends(subject, fact):
            self._end(iri, end, fact.since)

    def _stated_ends(self, subject: str, fact: facts.NodeInstance) -> list[facts.InstanceInterface]:
        """Return the ends to be stated; add which of the usual ones the instance has not."""
        record = self._records.get(fact.type) if fact.type else None
        own = {iri: end for end, iri in record.ends.items()} if record else {}
        usual = usual_ends(fact.name, fact.namespace, fact.type, own) if fact.type else {}
        by_usual: dict[str, list[facts.InstanceInterface]] = {iri: [] for iri in usual}
        stated: list[facts.InstanceInterface] = []
        for end in fact.interfaces:
            iri = record.ends.get(end.declared, "") if record and end.owner == fact.type else ""
            by_usual.get(iri, stated).append(end)
        for iri, ends in by_usual.items():
            if not ends:
                self._writer.add(subject, v.WITHOUT, f"<{iri}>")
            elif ends != [usual[iri]] or (ends[0].declared.role.channel, ends[0].resolved) in self._touched:
                stated += ends
        return stated

    def _start(self, owner: str, fact: facts.NodeInstance) -> None:
        """Add what an instance is started with, which it may share with those of other systems."""
        start = Start(self._scope, fact.started.chain)
        start.node(fact.started)
        remaps = [start.remap(one, place) for place, one in enumerate(fact.remaps)]
        settings = [start.parameter(one, place, self._sets(one)) for place, one in enumerate(fact.parameters)]
        sets = {one.set for one in fact.parameters}
        others = (end.parameter for end in fact.interfaces if end.parameter and end.parameter not in sets)
        entries = {other: None for other in others if (self._iri, other) not in self._settings}
        named = [(other, start.entry(other, place)) for place, other in enumerate(entries)]
        iri = start.write(self._writer)
        self._writer.add(f"<{owner}>", v.STARTED_WITH, f"<{iri}>")
        for rule, part in zip(fact.remaps, remaps, strict=True):
            self._remaps.setdefault((owner, rule.remap), f"<{iri}{part}>")
        for parameter, part in zip(fact.parameters, settings, strict=True):
            self._settings.setdefault((owner, parameter.set), f"<{iri}{part}>")
        for entry, part in named:
            self._settings[owner, entry] = f"<{iri}{part}>"

    def _sets(self, fact: facts.InstanceParameter) -> str | None:
        """Return the spelled IRI of the parameter of a node type that a parameter sets."""
        record = self._records.get(fact.owner) if fact.owner else None
        iri = record.settable.get(fact.declared) if record and fact.declared else None
        return f"<{iri}>" if iri else None

    def _setting(self, fact: facts.LaunchParameter, order: int) -> str:
        part, writer = self._scope.part(self._iri, "setting", fact.name.lstrip("/")), self._writer
        self._settings.setdefault((self._iri, fact), part)
        writer.add(part, v.TYPE, v.SETTING)
        writer.add(part, v.NAME, literal(fact.name))
        writer.add(part, v.ORDER, integer(order))
        SETTING.write(writer, part, fact)
        self._evidence(part, fact.location, fact.chain)
        return part

    def _end(self, owner: str, fact: facts.InstanceInterface, since: str | None) -> None:
        shape, writer, declared = SHAPES[fact.declared.role], self._writer, fact.declared
        part = self._scope.part(owner, shape.component, (fact.resolved or "").lstrip("/") or None)
        writer.add(f"<{owner}>", v.HAS_COMPONENT, part)
        record = self._records.get(fact.owner)
        code = f"<{record.ends[declared]}>" if record and declared in record.ends else None
        own = self._whole or code is None or fact.qos != declared.qos
        if code is not None:
            writer.add(part, v.DECLARED_BY if fact.qos == declared.qos else v.OVERRIDES, code)
        elif self._is_foreign(fact):
            self._foreign(part, fact)
        elif since is not None:
            writer.text(part, v.NAME, declared.name)
            self._evidence(part, declared.location, since=since)
        if own:
            self._stated(part, fact)
        nameless = not is_known(fact.resolved)
        if own or nameless:
            writer.text(part, v.RESOLVED_NAME, fact.resolved)
        if own or nameless or fact.resolution != usual_resolution(declared, fact.resolved, fact.parameter):
            writer.add(part, v.RESOLUTION, v.rnkg(fact.resolution))
        writer.text(part, v.REASON, fact.reason)
        for switch in fact.switches:
            writer.text(part, v.SWITCHED_BY, switch)
        self._causes(owner, part, fact)
        if is_known(fact.resolved):
            channel = self._channel(declared.role.channel, fact.resolved)
            writer.add(part, v.CONNECTS_TO, channel)
            if declared.type:
                kind = interface_type(self._scope, shape.type_kind, declared.type)
                writer.once(channel, shape.channel_has_type, kind)

    def _stated(self, part: str, fact: facts.InstanceInterface) -> None:
        """Add what the end of a node type would have, to an end that has none or differs from it."""
        shape, writer, declared = SHAPES[fact.declared.role], self._writer, fact.declared
        writer.add(part, v.TYPE, shape.component_class)
        writer.add(part, v.TYPE, v.INSTANCE_END)
        writer.add(part, v.DECLARED_BY, part)
        writer.add(part, v.IMPLICIT, boolean(declared.implicit))
        writer.text(part, v.PARAMETER_NAME, declared.parameter)
        if declared.type:
            kind = interface_type(self._scope, shape.type_kind, declared.type)
            writer.add(part, shape.has_type, kind)
            if self._is_foreign(fact):
                self._described.add(kind[:-1])
        if fact.qos is not None:
            policies = quality(self._scope, fact.qos)
            writer.add(part, v.HAS_QOS, policies)
            if fact.qos != declared.qos:
                self._overrides.add(policies)

    def _is_foreign(self, fact: facts.InstanceInterface) -> bool:
        """Tell whether no node type declares an end: it is a plugin's, whose code is not in the build."""
        return fact.owner not in self._records and fact.declared.origin is not None and not fact.declared.implicit

    def _foreign(self, part: str, fact: facts.InstanceInterface) -> None:
        """Add the evidence of an end that no node type declares."""
        declared, writer = fact.declared, self._writer
        writer.text(part, v.LOADS_LIBRARY, f"{fact.owner.package}/{fact.owner.node}")
        writer.text(part, v.NAME, declared.name)
        writer.text(part, v.WRITTEN, declared.written)
        writer.text(part, v.ORIGIN, declared.origin)
        self._evidence(part, declared.location)

    def _causes(self, owner: str, part: str, fact: facts.InstanceInterface) -> None:
        remap = fact.remap and self._remaps.get((owner, fact.remap))
        if remap:
            self._writer.add(part, v.REMAPPED_BY, remap)
        if fact.parameter is not None:
            own = self._settings.get((owner, fact.parameter))
            self._writer.add(part, v.NAMED_BY, own or self._settings[self._iri, fact.parameter])

    def _channel(self, kind: str, name: str) -> str:
        iri = f"<{fragment(self._iri, kind, name.lstrip('/'))}>"
        self._writer.described(iri, name)
        return iri

    def _evidence(
        self, subject: str, location: facts.Location, chain: tuple[facts.Location, ...] = (), since: str | None = None
    ) -> None:
        """Add the place of something. Files are described only in the graph of their source.

        For an observed thing it is the peer that showed it, and the time of the first observation.
        """
        if since is not None:
            self._writer.text(subject, v.SEEN_AT, location.path)
            self._writer.add(subject, v.SEEN_SINCE, moment(datetime.fromisoformat(since)))
            return
        writer, repository = self._writer, location.repository or self._scope.repository
        writer.add(subject, v.PATH, literal(location.path))
        writer.add(subject, v.LINE, integer(location.line))
        writer.add(subject, v.DECLARED_IN, f"<{self._scope.iris.file(repository, location.path)}>")
        if repository != self._scope.repository:
            writer.text(subject, v.IN_REPOSITORY, repository)
        writer.text(subject, v.INCLUDE_CHAIN, chain_text(chain))


def _touched(system: facts.System) -> set[tuple[str, str | None]]:
    """Return what has to do with ends that are not usual: kinds and names of channels."""
    ends = {
        (end.declared.role.channel, end.resolved)
        for one in system.instances
        for end in one.interfaces
        if not end.declared.implicit
    }
    rules = [rule for one in system.instances for rule in one.remaps]
    names = {name for rule in rules for name in (rule.source, rule.target)}
    alike = {(kind, name) for kind, *pair in system.similar for name in pair}
    return ends | alike | {(role.channel, name) for role in facts.Role for name in names}
