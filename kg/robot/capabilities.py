"""Inferred capabilities of systems and packages: definitions from ontologies, interfaces, and proofs."""

from __future__ import annotations

import json
from collections import defaultdict
from contextlib import suppress
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Final, Literal

import msgspec
import pyoxigraph
from pyoxigraph import NamedNode, Triple, Variable

from kg.errors import RobotError, UnknownNameError, UsageError
from kg.graph import vocabulary as v
from kg.graph.fields import Properties, one
from kg.graph.reading.queries import grouped, values
from kg.query.binding import bind
from kg.query.stored import internal
from kg.robot.capability import Capabilities, Capability, Parameter, Way, called
from kg.rules.explain.why import why
from kg.similar import did_you_mean
from kg.syntax.names import PREFIXES

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Mapping

    from kg.rules.explain.proof import Proof
    from kg.rules.explain.view import View
    from kg.rules.form import Rule
    from kg.store.interface import Queryable
    from kg.store.snapshot import EmbeddedSnapshot

_SKOS_ALTERNATIVE: Final = f"{v.SKOS}altLabel"
_PARTS: Final = {"read": frozenset({"response", "result", "feedback"}), "write": frozenset({"request", "goal"})}
"""The parts of services and actions that hold the values of capabilities, by modality."""
_TYPES: Final = frozenset({"number", "integer", "boolean", "text", "list"})


@dataclass(frozen=True, slots=True)
class Definition:
    """A capability as the ontologies define it, without interfaces.

    `fields` has the fields of messages for each parameter, `constants` the fields with fixed values; `implied` are the
    IRIs of more general capabilities. `rate` is the number of times per second that a command has to be repeated, 0 for
    never.
    """

    described: Capability
    fields: Mapping[str, tuple[str, ...]]
    constants: tuple[str, ...]
    implied: tuple[str, ...]
    rate: float

    def capability(self, *, ways: tuple[Way, ...] = (), implied_by: tuple[str, ...] = ()) -> Capability:
        """Return the capability for users: with its interfaces, and the capabilities that it follows from.

        It keeps only parameters with a field in some interface: a drone that takes off by an empty message has no
        height. A capability without interfaces keeps them all.
        """
        parameters = self.described.parameters
        if ways:
            named = {name for way in ways for name in way.fields}
            parameters = tuple(one for one in parameters if one.name in named)
        return msgspec.structs.replace(self.described, parameters=parameters, ways=ways, implied_by=implied_by)

    def anywhere(self) -> Capability:
        """Return the capability of a robot that is not known: what some of its messages lack is optional."""
        of_parameter = {name: {text.partition(" ")[0] for text in texts} for name, texts in self.fields.items()}
        every = set().union(*of_parameter.values())
        parameters = tuple(
            msgspec.structs.replace(one, optional=of_parameter[one.name] != every) for one in self.described.parameters
        )
        return msgspec.structs.replace(self.described, parameters=parameters)

    def fields_of(self, messages: frozenset[str]) -> dict[str, str]:
        """Return the paths of parameters in messages of these names, by the name of the parameter."""
        parts = _PARTS.get(self.described.modality, frozenset())
        paths = ((name, _path(texts, messages, parts)) for name, texts in self.fields.items())
        return {name: path for name, path in paths if path is not None}

    def constants_of(self, messages: frozenset[str]) -> dict[str, float | bool | str]:
        """Return the fixed values of fields of these messages, by their paths."""
        constants: dict[str, float | bool | str] = {}
        for text in self.constants:
            place, _, value = text.partition(" = ")
            path = _path((place,), messages, _PARTS.get(self.described.modality, frozenset()))
            if path is not None:
                constants[path] = _value(value)
        return constants


def definitions(graph: Queryable) -> dict[str, Definition]:
    """Return the capabilities that a graph with ontologies defines, by IRI."""
    content = grouped(values(graph.query(internal("capability-definitions"), prefixes=PREFIXES)))
    kinds = _Kinds(graph)
    return {
        iri: _definition(iri, properties, content, kinds)
        for iri, properties in sorted(content.items())
        if v.bare(v.ros("hasModality")) in properties
    }


def _definition(iri: str, own: Properties, content: Mapping[str, Properties], kinds: _Kinds) -> Definition:
    parameters = sorted(
        (content[part] for part in own.get(v.bare(v.rnkg("hasParameter")), ()) if part in content),
        key=lambda part: (float(one(part, v.ORDER) or 0), one(part, v.NAME) or ""),
    )
    seconds = float(one(own, v.rnkg("renewedEvery")) or 0)
    modality: Any = (one(own, v.ros("hasModality")) or "").rpartition("#")[2]
    described = Capability(
        iri=iri,
        name=iri.rpartition("#")[2],
        label=one(own, v.LABEL) or iri,
        comment=one(own, v.COMMENT) or "",
        modality=modality,
        kinds=kinds.of(own.get(v.bare(v.TYPE), ())),
        alternatives=tuple(sorted(own.get(_SKOS_ALTERNATIVE, ()))),
        parameters=tuple(map(_parameter, parameters)),
        moves=one(own, v.rnkg("movedPart")),
    )
    return Definition(
        described,
        fields={one(part, v.NAME) or "": tuple(sorted(part.get(v.bare(v.rnkg("field")), ()))) for part in parameters},
        constants=tuple(sorted(own.get(v.bare(v.rnkg("constantField")), ()))),
        implied=tuple(sorted(own.get(v.bare(v.rnkg("impliesCapability")), ()))),
        rate=1 / seconds if seconds > 0 else 0,
    )


def _parameter(own: Properties) -> Parameter:
    kind: Any = one(own, v.rnkg("parameterKind"))
    default = one(own, v.rnkg("defaultValue"))
    return Parameter(
        name=one(own, v.NAME) or "",
        label=one(own, v.LABEL) or one(own, v.NAME) or "",
        comment=one(own, v.COMMENT) or "",
        type=kind if kind in _TYPES else "number",
        unit=one(own, v.rnkg("unit")),
        default=None if default is None else default if kind == "text" else _value(default),
        minimum=_number(one(own, v.rnkg("minimum"))),
        maximum=_number(one(own, v.rnkg("maximum"))),
        choices=tuple(sorted(own.get(v.bare(v.CHOICE), ()))),
    )


def _number(text: str | None) -> float | None:
    return None if text is None else float(text)


def _value(text: str) -> float | bool | str:
    with suppress(ValueError):
        value = json.loads(text)
        if isinstance(value, bool | int | float | str):
            return value
    return text


def _path(texts: Iterable[str], messages: frozenset[str], parts: frozenset[str]) -> str | None:
    """Return the path that one of `texts` declares for one of `messages`.

    A text is `std_msgs/Bool data`, or with a part `std_srvs/SetBool request data`. A context names the whole service
    (`std_srvs/SetBool`), which matches its `parts`.
    """
    for text in texts:
        message, _, path = text.rpartition(" ")
        whole, _, part = message.partition(" ")
        if message in messages or (whole in messages and part in parts):
            return path
    return None


class _Kinds:
    def __init__(self, graph: Queryable) -> None:
        self._labels: dict[str, str] = {}
        self._broader: dict[str, set[str]] = {}
        for row in graph.query(internal("capability-kinds"), prefixes=PREFIXES):
            self._labels[row["class"].value] = row["label"].value
            self._broader.setdefault(row["class"].value, set()).add(row["broader"].value)

    def of(self, classes: list[str] | tuple[()]) -> tuple[str, ...]:
        """Return the labels from the most general class to the most specific one of these."""
        chains = [tuple(self._chain(one)) for one in sorted(classes) if one in self._labels]
        return tuple(self._labels[one] for one in reversed(max(chains, key=len, default=())))

    def _chain(self, name: str) -> Iterator[str]:
        seen: set[str] = set()
        while name in self._labels and name not in seen:
            seen.add(name)
            yield name
            name = min(self._broader[name] & self._labels.keys(), default="")


_KINDS: Final[Mapping[str, Literal["topic", "service", "action"]]] = {
    v.bare(v.PUBLISHER): "topic",
    v.bare(v.SUBSCRIBER): "topic",
    v.bare(v.SERVICE_SERVER): "service",
    v.bare(v.ACTION_SERVER): "action",
}


def capabilities_of(graph: Queryable, whole: str, of: str) -> Capabilities:
    """Return the inferred capabilities of the system or package with the IRI `whole`; `of` is its name."""
    return read(graph, whole, of, definitions(graph))


def capability_labels(graph: Queryable, whole: str) -> dict[str, str]:
    """Return the IRIs of the capabilities of the system or package with the IRI `whole`, with their labels."""
    return {row["capability"].value: row["label"].value for row in _rows(graph, "capability-holders", whole)}


def read(graph: Queryable, whole: str, of: str, known: Mapping[str, Definition]) -> Capabilities:
    """Return the capabilities, given definitions that were read before."""
    having = {iri for iri in capability_labels(graph, whole) if iri in known}
    ways: defaultdict[str, dict[tuple[str, str, str, str], set[str]]] = defaultdict(dict)
    """The messages of each capability, by kind, name, type and node of the interface."""
    for row in _rows(graph, "capability-ways", whole):
        key = (_KINDS[row["role"].value], row["channel"].value, row["type"].value, row["node"].value)
        ways[row["capability"].value].setdefault(key, set()).add(row["message"].value)
    every = [
        known[iri].capability(
            ways=tuple(_way(known[iri], key, frozenset(messages)) for key, messages in sorted(ways[iri].items())),
            implied_by=tuple(sorted(known[each].described.name for each in having if iri in known[each].implied)),
        )
        for iri in having
    ]
    return Capabilities(of=of, capabilities=tuple(sorted(every, key=lambda one: (one.kinds, one.label, one.iri))))


def _rows(graph: Queryable, name: str, whole: str) -> Iterable[Any]:
    rows: Iterable[Any] = graph.query(bind(internal(name), {"whole": NamedNode(whole)}), prefixes=PREFIXES)
    return rows


def _way(definition: Definition, key: tuple[str, str, str, str], messages: frozenset[str]) -> Way:
    kind: Any = key[0]
    return Way(
        kind=kind,
        name=key[1],
        type=key[2],
        node=key[3],
        fields=definition.fields_of(messages),
        constants=definition.constants_of(messages),
        rate=definition.rate if kind == "topic" else 0,
    )


_PACKAGES = """SELECT ?iri ?name ?repository WHERE {
  ?owner <%(rnkg)scontains> ?iri ; <%(rnkg)sname> ?repository .
  ?iri a <%(rnkg)sPackage> ; <%(rnkg)sname> ?name .
} ORDER BY ?repository""" % {"rnkg": v.RNKG}  # noqa: UP031 - braces are those of SPARQL


def added(subject: Capabilities, base: Capabilities) -> Capabilities:
    """Return the capabilities that one subject has and another lacks."""
    present = {one.iri for one in base.capabilities}
    return msgspec.structs.replace(
        subject, capabilities=tuple(one for one in subject.capabilities if one.iri not in present)
    )


def package_iri(snapshot: EmbeddedSnapshot, name: str) -> str:
    """Return the IRI of a package, `name` or `repository:name`.

    Raises:
        UnknownNameError: KG001 no such package.
        UsageError: KG003 several packages.
    """
    repository, _, plain = name.rpartition(":")
    rows: Any = snapshot.query(_PACKAGES, substitutions={Variable("name"): pyoxigraph.Literal(plain)})
    packages = [(row["iri"].value, row["repository"].value) for row in rows]
    packages = [one for one in packages if repository in {"", one[1]}]
    if not packages:
        every: Any = snapshot.query(_PACKAGES)
        hint = did_you_mean(plain, {row["name"].value for row in every}) or "`kg packages` lists those of the store."
        raise UnknownNameError("KG001", f"the store has no package `{name}`", hint=hint)
    if len(packages) > 1:
        ways = "\n".join(f"`{source}:{plain}`" for _, source in packages)
        raise UsageError("KG003", f"{len(packages)} packages are called `{plain}`; choose one", hint=ways)
    return str(packages[0][0])


_HOLDERS = """SELECT DISTINCT ?node WHERE {
  <%s> <https://w3id.org/rnkg/ns#hasInstance>|<https://w3id.org/rnkg/ns#contains> ?node .
  ?node <https://w3id.org/rnkg/ns#hasCapability> <%s> .
} ORDER BY ?node"""


def find(capabilities: Capabilities, name: str) -> Capability:
    """Return the capability of a name, label, alternative label or IRI.

    Raises RobotError KG818 if there is none, with suggestions.
    """
    matches = called(capabilities, name.strip().removeprefix("capability:"))
    if matches:
        return matches[0]
    names = [text for one in capabilities.capabilities for text in (one.name, one.label)]
    raise RobotError("KG818", f"{capabilities.of} has no capability `{name}`", hint=did_you_mean(name, names))


def proofs(
    graph: Queryable, view: View, rules: tuple[Rule, ...], whole: str, capability: Capability
) -> Iterator[Proof]:
    """Yield the shortest proof of a capability for each node of a system or package that has it.

    `view` is the graph as explanations with these rules see it. Raises RuleError KG226 if rules do not infer it.
    """
    rows: Any = graph.query(_HOLDERS % (whole, capability.iri))
    predicate = NamedNode(v.bare(v.rnkg("hasCapability")))
    for node in [row["node"] for row in rows]:
        yield why(view, rules, Triple(node, predicate, NamedNode(capability.iri)), shortest=True)
