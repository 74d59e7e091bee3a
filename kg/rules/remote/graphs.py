"""The temporary graphs of one run on a server.

    <inferred>/delta-3f2a/asserted      what rules read as asserted, each triple once
    <inferred>/delta-3f2a/derived       what was derived so far; becomes <inferred> at the end
    <inferred>/delta-3f2a/new           what rules gave in this round, known or not
    <inferred>/delta-3f2a/delta         what was new in the last round
    <inferred>/delta-3f2a/auxiliary...  the last three for predicates that decomposition introduced
    <inferred>/delta-3f2a/stated        triples that rule files state and nothing else asserts

`asserted` and `derived` share nothing, so rules that read both meet each triple once: what a server makes of a triple
that two graphs have differs, and aggregates would count it twice. Auxiliary triples have graphs of their own, for a
variable in the place of a predicate must not match them.
"""

from __future__ import annotations

from dataclasses import dataclass
from uuid import uuid4

from pyoxigraph import NamedNode

from kg.rules.form import Pattern, is_auxiliary


@dataclass(frozen=True, slots=True)
class Channel:
    """Where triples of one kind go: all that were derived, those of this round, and the new ones of the last."""

    derived: NamedNode
    new: NamedNode
    delta: NamedNode


@dataclass(frozen=True, slots=True)
class Graphs:
    """The graphs of one run; `asserted` is one of the server's own where it has a single one."""

    prefix: str
    asserted: NamedNode
    stated: NamedNode
    plain: Channel
    auxiliary: Channel

    @classmethod
    def below(cls, inferred: NamedNode) -> Graphs:
        """Return names that no other run has."""
        prefix = f"{inferred.value}/delta-{uuid4().hex[:8]}/"

        def named(name: str) -> NamedNode:
            return NamedNode(prefix + name)

        def channel(start: str) -> Channel:
            return Channel(named(f"{start}derived"), named(f"{start}new"), named(f"{start}delta"))

        return cls(prefix, named("asserted"), named("stated"), channel(""), channel("auxiliary-"))

    @property
    def channels(self) -> tuple[Channel, Channel]:
        """That of plain triples and that of auxiliary ones."""
        return self.plain, self.auxiliary

    def channel(self, predicate: Pattern) -> Channel:
        """Return where triples of a predicate go."""
        return self.auxiliary if is_auxiliary(predicate) else self.plain

    @property
    def temporary(self) -> list[NamedNode]:
        """All graphs that the run makes."""
        made = [graph for each in self.channels for graph in (each.derived, each.new, each.delta)]
        return [*made, self.stated, NamedNode(self.prefix + "asserted")]
