"""The plain values of facts in the graph, each declared once: which property holds it, how it is spelled and read.

    INTERFACE.write(writer, part, fact)                             # all but None, one triple each
    Interface(role=..., location=..., **INTERFACE.read(properties))

Values that are things themselves (types, files, channels) and where a fact was read are not among them.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from contextlib import suppress
from dataclasses import dataclass
from functools import cache, cached_property
from typing import Any, Final, TypeAlias

from kg.facts import Access, LaunchProblemKind, Location, NodeKind, Resolution
from kg.graph import vocabulary as v
from kg.graph.ntriples import Writer, boolean, double, integer, literal

Properties: TypeAlias = Mapping[str, list[str]]
"""The properties of one thing in the graph: values by the IRIs of properties."""


_PLACE: Final = (v.bare(v.PATH), v.bare(v.LINE), v.bare(v.IN_REPOSITORY))


def one(properties: Properties, term: str) -> str | None:
    """Return the value of a term that has one; the least where it has several."""
    return _least(properties.get(term[1:-1]))


def _least(values: list[str] | None) -> str | None:
    return None if values is None else values[0] if len(values) == 1 else min(values, default=None)


def place_of(properties: Properties) -> Location:
    """Return the line where a thing was read."""
    path, line, repository = map(_least, map(properties.get, _PLACE))
    return Location(path or "", int(line or 0), repository)


def word(properties: Properties, term: str) -> str:
    """Return the local name of a term of RNKG."""
    return _local(one(properties, term) or "")


def _local(iri: str) -> str:
    return iri.removeprefix(v.RNKG)


@dataclass(frozen=True, slots=True)
class _Field:
    """One attribute of a fact; `unwritten` is a value that is not written.

    `parse` is given None where the property is missing; without it the attribute is the text, or None.
    `several` is a tuple of texts, one triple each; it is sorted when it is read.
    """

    name: str
    term: str
    spell: Callable[[Any], str] = literal
    parse: Callable[[str | None], Any] | None = None
    unwritten: Any = None
    several: bool = False


class Fields:
    """The plain values of facts of one class, in the order in which they are written."""

    def __init__(self, *fields: _Field) -> None:
        self._fields = fields
        self.terms: Final = tuple(field.term for field in fields)
        # Read for each of a hundred thousand facts, which lack most properties.
        self._readers = {v.bare(field.term): (field.name, field.several, field.parse) for field in fields}

    def rows(self, fact: object) -> list[tuple[str, str]]:
        """Return each property with a spelled value."""
        pairs: list[tuple[str, str]] = []
        for field in self._fields:
            value = getattr(fact, field.name)
            if field.several:
                pairs += [(field.term, field.spell(one)) for one in dict.fromkeys(value)]
            elif value is not None and value != field.unwritten:
                pairs.append((field.term, field.spell(value)))
        return pairs

    def write(self, writer: Writer, subject: str, fact: object) -> None:
        """Add the values of a fact as properties of a spelled IRI."""
        writer.lines += [f"{subject} {term} {value} .\n" for term, value in self.rows(fact)]

    def read(self, properties: Properties) -> dict[str, Any]:
        """Return the values of a fact by the names of its attributes; ValueError for a word that is not known.

        A word that is missing is not known either.
        """
        values_by_name = self._missing.copy()
        for term, values in properties.items():
            if (reader := self._readers.get(term)) and values:
                name, several, parse = reader
                value = values[0] if len(values) == 1 else min(values)
                values_by_name[name] = tuple(sorted(values)) if several else value if parse is None else parse(value)
        if len(values_by_name) < len(self._readers):
            raise ValueError(
                f"missing: {', '.join(one.name for one in self._fields if one.name not in values_by_name)}"
            )
        return values_by_name

    @cached_property
    def _missing(self) -> dict[str, Any]:
        """The values of attributes whose properties are missing, without those that need one."""
        found: dict[str, Any] = {}
        for name, several, parse in self._readers.values():
            with suppress(ValueError):
                found[name] = () if several else parse and parse(None)
        return found


def _flag(name: str, term: str) -> _Field:
    return _Field(name, term, boolean, lambda text: text == "true")


def _word(name: str, term: str, kind: Callable[[str], Any]) -> _Field:
    """Return an attribute that is an enumerator, for which RNKG has a term."""
    return _Field(name, term, v.rnkg, cache(lambda iri: kind(_local(iri or ""))))


def _count(text: str | None) -> int:
    return int(text or 0)


def _measure(name: str, term: str) -> _Field:
    return _Field(name, term, double, lambda text: None if text is None else float(text))


_RESOLUTION: Final = _word("resolution", v.RESOLUTION, Resolution)
_IMPLICIT: Final = _flag("implicit", v.IMPLICIT)
_ORIGIN: Final = _Field("origin", v.ORIGIN)
_REASON: Final = _Field("reason", v.REASON)

NODE: Final = Fields(
    _Field("name", v.NAME),
    _word("kind", v.KIND, NodeKind),
    _Field("language", v.LANGUAGE),
    _Field("ros", v.ROS_VERSION, integer, _count),
    _Field("plugin", v.PLUGIN_NAME),
    _Field("node_name", v.NODE_NAME),
    _Field("node_namespace", v.NODE_NAMESPACE),
    _Field("base_class", v.BASE_CLASS),
    _Field("aliases", v.ALIAS, several=True),
)
INTERFACE: Final = Fields(
    _Field("name", v.NAME),
    _Field("resolved", v.RESOLVED_NAME),
    _RESOLUTION,
    _IMPLICIT,
    _Field("written", v.WRITTEN),
    _Field("parameter", v.PARAMETER_NAME),
    _ORIGIN,
    _Field("arguments", v.LEAST_ARGUMENTS, integer, _count, unwritten=0),
    _Field("switches", v.SWITCHED_BY, several=True),
    _Field("silent", v.NEVER_PUBLISHES, boolean, lambda text: text == "true", unwritten=False),
    _Field("ignored", v.IGNORES_MESSAGES, boolean, lambda text: text == "true", unwritten=False),
    _Field("upon", v.PUBLISHES_UPON, several=True),
    _Field("unset", v.LEAVES_UNSET, several=True),
    _Field("filled", v.SETS_PART, several=True),
    _REASON,
)
QOS: Final = Fields(
    _Field("reliability", v.RELIABILITY),
    _Field("durability", v.DURABILITY),
    _Field("history", v.HISTORY),
    _Field("depth", v.DEPTH, integer, lambda text: None if text is None else int(text)),
    _measure("deadline", v.DEADLINE),
    _measure("lifespan", v.LIFESPAN),
    _Field("liveliness", v.LIVELINESS),
    _measure("lease_duration", v.LEASE_DURATION),
)
PARAMETER: Final = Fields(
    _Field("name", v.NAME),
    _Field("type", v.PARAMETER_TYPE),
    _Field("default", v.DEFAULT_VALUE),
    _Field("description", v.DESCRIPTION),
    _word("access", v.ACCESS, Access),
    _RESOLUTION,
    _IMPLICIT,
    _ORIGIN,
    _REASON,
)
SLOT: Final = Fields(
    _Field("base_class", v.LOADS_AS),
    _Field("names", v.NAMES_PARAMETER),
    _Field("parameter", v.CLASS_PARAMETER),
    _flag("fixed", v.CLASS_FIXED),
    _REASON,
)
ARGUMENT: Final = Fields(
    _Field("name", v.NAME),
    _Field("default", v.DEFAULT_VALUE),
    _Field("value", v.VALUE),
    _Field("description", v.DESCRIPTION),
    _flag("fixed", v.FIXED),
    _Field("choices", v.CHOICE, several=True),
)
PROBLEM: Final = Fields(
    _Field("kind", v.PROBLEM_KIND, parse=lambda text: LaunchProblemKind(text or "")),
    _Field("message", v.TEXT),
    _Field("subject", v.SUBJECT),
)
SETTING: Final = Fields(_Field("value", v.VALUE), _Field("type", v.PARAMETER_TYPE), _REASON)
"""Of a parameter that a launch file sets; its name may differ between the file and an instance."""
