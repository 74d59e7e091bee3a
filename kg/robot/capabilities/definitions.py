"""What capabilities are, read from the ontologies: names, kinds, parameters with units, and fields of messages."""

from __future__ import annotations

import json
from contextlib import suppress
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any, Final, Protocol

from kg.graph import vocabulary as v
from kg.graph.fields import one
from kg.graph.reading import grouped
from kg.query.stored import internal
from kg.robot.capability import Capability, Parameter
from kg.syntax.names import PREFIXES

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Mapping

    from kg.graph.fields import Properties
    from kg.robot.capability import Way

__all__ = ["Askable", "Definition", "definitions"]

_SKOS_ALTERNATIVE: Final = f"{v.SKOS}altLabel"
_PARTS: Final = {"read": frozenset({"response", "result", "feedback"}), "write": frozenset({"request", "goal"})}
"""The parts of services and actions that hold what a capability of a modality gives or takes."""
_TYPES: Final = frozenset({"number", "integer", "boolean", "text", "list"})


class Askable(Protocol):
    """What can be asked in SPARQL: a snapshot, a transaction, a store in memory."""

    def query(self, text: str, /, *, prefixes: Mapping[str, str] | None = None) -> Any:
        """Run a query over all there is."""


@dataclass(frozen=True, slots=True)
class Definition:
    """A capability as the ontologies define it.

    `fields` has for each parameter the places of messages that hold it, `constants` the values of places that are
    always the same; `implied` are the IRIs of more general capabilities. `rate` is how often a second a command has to
    be renewed, 0 for never; `moves` is the part of the robot that is moved.
    """

    iri: str
    name: str
    label: str
    comment: str
    modality: str
    kinds: tuple[str, ...] = ()
    alternatives: tuple[str, ...] = ()
    parameters: tuple[Parameter, ...] = ()
    fields: Mapping[str, tuple[str, ...]] = field(default_factory=dict)
    constants: tuple[str, ...] = ()
    implied: tuple[str, ...] = ()
    rate: float = 0
    moves: str | None = None

    def capability(self, *, ways: tuple[Way, ...] = (), implied_by: tuple[str, ...] = ()) -> Capability:
        """Return it as those see it who use it: with the ways to reach it, and what it follows from.

        Of its parameters it keeps those that some way has a field for: a drone that takes off by an empty message
        cannot be told a height. A capability without ways keeps them all.
        """
        modality: Any = self.modality
        told = {name for way in ways for name in way.fields} if ways else self.fields.keys()
        return Capability(
            iri=self.iri,
            name=self.name,
            label=self.label,
            comment=self.comment,
            alternatives=self.alternatives,
            kinds=self.kinds,
            modality=modality,
            parameters=tuple(one for one in self.parameters if one.name in told),
            ways=ways,
            implied_by=implied_by,
            moves=self.moves,
        )

    def fields_of(self, messages: frozenset[str]) -> dict[str, str]:
        """Return the paths of parameters in messages of these names, by the name of the parameter."""
        parts = _PARTS.get(self.modality, frozenset())
        found = ((name, _path(texts, messages, parts)) for name, texts in self.fields.items())
        return {name: path for name, path in found if path is not None}

    def constants_of(self, messages: frozenset[str]) -> dict[str, float | bool | str]:
        """Return the values of fields of these messages that are always the same, by their paths."""
        found: dict[str, float | bool | str] = {}
        for text in self.constants:
            place, _, value = text.partition(" = ")
            path = _path((place,), messages, _PARTS.get(self.modality, frozenset()))
            if path is not None:
                found[path] = _value(value)
        return found


def definitions(graph: Askable) -> dict[str, Definition]:
    """Return the capabilities that a graph with ontologies defines, by IRI."""
    content = grouped(graph.query(internal("capability-definitions"), prefixes=PREFIXES))
    kinds = _Kinds(graph)
    return {
        iri: _definition(iri, properties, content, kinds)
        for iri, properties in sorted(content.items())
        if v.bare(v.ros("hasModality")) in properties
    }


def _definition(iri: str, own: Properties, content: Mapping[str, Properties], kinds: _Kinds) -> Definition:
    parameters = sorted(
        (content[part] for part in own.get(v.bare(v.rnkg("hasParameter")), ()) if part in content), key=_order
    )
    seconds = float(one(own, v.rnkg("renewedEvery")) or 0)
    return Definition(
        iri=iri,
        name=iri.rpartition("#")[2],
        label=one(own, v.LABEL) or iri,
        comment=one(own, v.COMMENT) or "",
        modality=(one(own, v.ros("hasModality")) or "").rpartition("#")[2],
        kinds=kinds.of(own.get(v.bare(v.TYPE), ())),
        alternatives=tuple(sorted(own.get(_SKOS_ALTERNATIVE, ()))),
        parameters=tuple(map(_parameter, parameters)),
        fields={one(part, v.NAME) or "": tuple(sorted(part.get(v.bare(v.rnkg("field")), ()))) for part in parameters},
        constants=tuple(sorted(own.get(v.bare(v.rnkg("constantField")), ()))),
        implied=tuple(sorted(own.get(v.bare(v.rnkg("impliesCapability")), ()))),
        rate=1 / seconds if seconds > 0 else 0,
        moves=one(own, v.rnkg("movedPart")),
    )


def _order(own: Properties) -> tuple[float, str]:
    return float(one(own, v.ORDER) or 0), one(own, v.NAME) or ""


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
    """Return what a text means as JSON, if it is JSON, else the text itself."""
    with suppress(ValueError):
        value = json.loads(text)
        if isinstance(value, bool | int | float | str):
            return value
    return text


def _path(texts: Iterable[str], messages: frozenset[str], parts: frozenset[str]) -> str | None:
    """Return the path that one of `texts` declares for one of `messages`.

    A text is `std_msgs/Bool data`, or with a part `std_srvs/SetBool request data`. A context names the service as a
    whole (`std_srvs/SetBool`), which stands for its `parts`.
    """
    for text in texts:
        message, _, path = text.rpartition(" ")
        whole, _, part = message.partition(" ")
        if message in messages or (whole in messages and part in parts):
            return path
    return None


class _Kinds:
    """The classes of capabilities: their labels, and what they are kinds of."""

    def __init__(self, graph: Askable) -> None:
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
