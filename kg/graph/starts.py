"""What launch files start and with what: a program, its remappings and parameters, once for all instances of it.

A launch file that many others include starts the same nodes in each of their systems, with the same parameters.
"""

from __future__ import annotations

import hashlib
from typing import TYPE_CHECKING, Final

from kg.graph import vocabulary as v
from kg.graph.chains import chain_text, likely_chain
from kg.graph.fields import SETTING
from kg.graph.iris import Iris, fragment
from kg.graph.ntriples import Writer, apart, integer, literal

if TYPE_CHECKING:
    from collections.abc import Iterable

    from kg.facts import InstanceParameter, InstanceRemap, LaunchParameter, Location, StartedNode
    from kg.graph.scope import Scope

STARTS: Final = "starts"
"""The name of the graph that has them."""
_BYTES: Final = 12


def starts_apart(content: bytes, iris: Iris) -> tuple[list[bytes], list[bytes]]:
    """Return the lines of N-Triples about anything else, and those that describe starts, in their order."""
    return apart(content, f"<{iris.base}start/".encode())


def start_of(line: bytes) -> bytes:
    """Return the IRI of the start that a line of N-Triples describes."""
    return line.partition(b">")[0].partition(b"#")[0][1:]


class Start:
    """What one instance is started with; `chain` are the includes that led to it."""

    def __init__(self, scope: Scope, chain: tuple[Location, ...]) -> None:
        self._scope = scope
        self._chain = chain
        self._parts: dict[str, str] = {}
        """The relation to each part."""
        self._rows: list[tuple[str, str, str]] = []
        self._counts: dict[str, int] = {}

    def node(self, fact: StartedNode) -> None:
        """Add what is started."""
        self._add("", v.START_KIND, literal(fact.kind))
        arguments = " ".join(fact.arguments) or None
        texts = {v.STARTS_PACKAGE: fact.package, v.STARTS_EXECUTABLE: fact.executable, v.STARTS_PLUGIN: fact.plugin}
        for term, text in {**texts, v.START_ARGUMENT: arguments}.items():
            if text is not None:
                self._add("", term, literal(text))
        for name, value in dict.fromkeys(fact.settings):
            self._add("", v.START_SETTING, literal(f"{name}={value}"))

    def remap(self, fact: InstanceRemap, order: int) -> str:
        """Add a remapping; return its suffix of the IRI of the start."""
        part = self._part("remap", fact.source, v.HAS_REMAP)
        self._add(part, v.TYPE, v.REMAP)
        self._add(part, v.FROM, literal(fact.source))
        self._add(part, v.TO, literal(fact.target))
        self._finish(part, order, fact.similar, fact.remap.location, fact.remap.chain)
        return part

    def parameter(self, fact: InstanceParameter, order: int, sets: str | None) -> str:
        """Add a parameter, which `sets` one of a node type (a spelled IRI); return as `remap` does."""
        part = self._part("setting", fact.name, v.HAS_SETTING)
        self._set(part, fact.name, fact.set)
        if sets is not None:
            self._add(part, v.SETS, sets)
        self._finish(part, order, fact.similar, fact.set.location, fact.set.chain)
        return part

    def entry(self, fact: LaunchParameter, order: int) -> str:
        """Add what names an end and is not a parameter, as a node of a behavior tree; return as `remap` does."""
        part = self._part("entry", fact.name, v.READS_ENTRY)
        self._set(part, fact.name, fact)
        self._finish(part, order, (), fact.location, fact.chain)
        return part

    def _set(self, part: str, name: str, fact: LaunchParameter) -> None:
        self._add(part, v.TYPE, v.SETTING)
        self._add(part, v.NAME, literal(name))
        for term, value in SETTING.rows(fact):
            self._add(part, term, value)

    def write(self, writer: Writer) -> str:
        """Add all triples, once for each start; return its IRI."""
        content = "".join(f"{' '.join(row)}\n" for row in self._rows)
        digest = hashlib.blake2b(content.encode(), digest_size=_BYTES).hexdigest()
        iri = self._scope.iris.start(self._scope.repository, digest)
        if writer.first(f"<{iri}>"):
            for part, relation in self._parts.items():
                writer.add(f"<{iri}>", relation, f"<{iri}{part}>")
            for part, term, value in self._rows:
                writer.add(f"<{iri}{part}>", term, value)
        return iri

    def _part(self, kind: str, name: str, relation: str) -> str:
        key = fragment("", kind, name.lstrip("/"))
        count = self._counts[key] = self._counts.get(key, 0) + 1
        part = fragment("", kind, name.lstrip("/"), count)
        self._parts[part] = relation
        return part

    def _add(self, part: str, term: str, value: str) -> None:
        self._rows.append((part, term, value))

    def _finish(
        self, part: str, order: int, similar: Iterable[str], location: Location, chain: tuple[Location, ...]
    ) -> None:
        """Add the place of a part among its like, and in its file; how that was reached where it does not follow."""
        self._add(part, v.ORDER, integer(order))
        for name in similar:
            self._add(part, v.RESEMBLES_NAME, literal(name))
        own = self._scope.repository
        self._add(part, v.PATH, literal(location.path))
        self._add(part, v.LINE, integer(location.line))
        if location.repository not in {None, own}:
            self._add(part, v.IN_REPOSITORY, literal(location.repository or ""))
        if chain != likely_chain(location.path, self._chain):
            self._add(part, v.INCLUDE_CHAIN, literal(chain_text(chain) or ""))
