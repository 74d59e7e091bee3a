"""What the graph of a running system holds, node by node, so that a change costs what the nodes cost that changed."""

from __future__ import annotations

from collections import Counter
from typing import TYPE_CHECKING

from kg.graph.shared import split
from kg.graph.systems import system_parts

if TYPE_CHECKING:
    from collections.abc import Mapping
    from collections.abc import Set as AbstractSet

    from kg.facts import NodeInstance, NodeReference, System
    from kg.graph.iris import Iris
    from kg.graph.reading import NodeRecord

__all__ = ["Parts"]

_Lines = frozenset[bytes]


class Parts:
    """The lines of a graph by the instance that says them; many say the same of a channel or a type.

    `described` are the subjects that other graphs of the store describe, which are left to these.
    """

    def __init__(self, iris: Iris, described: AbstractSet[bytes]) -> None:
        self._iris = iris
        self._described = described
        self._instances: dict[str, NodeInstance] = {}
        self._lines: dict[str, _Lines] = {}
        self._counts: Counter[bytes] = Counter()
        """How many parts say a line."""

    def change(self, system: System, records: Mapping[NodeReference, NodeRecord]) -> tuple[bytes, bytes]:
        """Take the system as it is now; return the lines that went and that came (N-Triples, sorted).

        Instances that are the same as before (`is`) are taken to say the same: `records` only grow.
        """
        before, self._lines = self._lines, {}
        instances: dict[str, NodeInstance] = {}
        for iri, instance, content in system_parts(system, records, self._iris, self._instances):
            self._lines[iri] = before[iri] if content is None else self._own(content)
            if instance is not None:
                instances[iri] = instance
        self._instances = instances
        return self._differences(before)

    def _own(self, content: bytes) -> _Lines:
        own, shared = split(content, self._iris)
        return frozenset([*own, *(line for line in shared if line.partition(b" ")[0] not in self._described)])

    def _differences(self, before: Mapping[str, _Lines]) -> tuple[bytes, bytes]:
        """Return which lines no part says any more, and which none said before; what moved is counted up first."""
        nothing = _Lines()
        pairs = [
            (before.get(iri, nothing), self._lines.get(iri, nothing))
            for iri in {**before, **self._lines}
            if before.get(iri) is not self._lines.get(iri)
        ]
        counts = self._counts
        gone: list[bytes] = []
        new: list[bytes] = []
        for old, lines in pairs:
            for line in lines - old:
                if not counts[line]:
                    new.append(line)
                counts[line] += 1
        for old, lines in pairs:
            for line in old - lines:
                counts[line] -= 1
                if not counts[line]:
                    del counts[line]
                    gone.append(line)
        return b"".join(sorted(gone)), b"".join(sorted(new))
