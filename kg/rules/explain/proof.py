"""Parts of an explanation: facts, the rules that derive them, and their places in the sources."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING, TypeAlias

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping

    from pyoxigraph import Triple

    from kg.rules.form import Element, Rule, Term


@dataclass(frozen=True, slots=True)
class Evidence:
    """The source line that an asserted fact was read from; `thing` is the IRI of the thing on it."""

    path: str
    line: int | None = None
    repository: str | None = None
    thing: str | None = field(default=None, compare=False)

    def __str__(self) -> str:
        return self.path if self.line is None else f"{self.path}:{self.line}"


@dataclass(frozen=True, slots=True)
class Condition:
    """A part of a body that is not a fact: a filter, something that is absent, a value computed from others.

    `facts` are some of those that were aggregated, `count` how many there were.
    """

    text: str
    facts: tuple[Triple, ...] = ()
    count: int | None = None


@dataclass(frozen=True, slots=True)
class Derivation:
    """One application of a rule: the bindings of its variables, the facts it matched and the conditions that held."""

    rule: Rule
    bindings: Mapping[str, Term]
    facts: tuple[Triple, ...]
    conditions: tuple[Condition, ...] = ()


@dataclass(frozen=True, slots=True)
class Proof:
    """Why a fact holds: it is asserted in `graphs`, or `derivation` derives it from `premises`."""

    fact: Triple
    graphs: tuple[str, ...] = ()
    evidence: Evidence | None = None
    derivation: Derivation | None = None
    premises: tuple[Premise, ...] = ()

    def walk(self) -> Iterator[tuple[int, Premise]]:
        """Yield this proof and everything below it, parents first, each with its depth; a fact is opened once."""
        seen: set[Triple] = set()
        waiting: list[tuple[int, Premise]] = [(0, self)]
        while waiting:
            depth, premise = waiting.pop()
            yield depth, premise
            if isinstance(premise, Proof) and premise.fact not in seen:
                seen.add(premise.fact)
                waiting.extend((depth + 1, below) for below in reversed(premise.premises))


Premise: TypeAlias = Proof | Condition


@dataclass(frozen=True, slots=True)
class Attempt:
    """How far one rule comes towards a fact: `matched` facts hold, `failing` does not, with what was `bound` by then.

    `failing` is None when the whole body matches: then rules have not been run since the data changed. `nearest` are
    sentences about what the store has instead; `deeper` explains why a premise that rules could derive is missing.
    """

    rule: Rule
    bound: Mapping[str, Term]
    matched: tuple[Triple, ...]
    failing: Element | None
    text: str
    nearest: tuple[str, ...] = ()
    deeper: WhyNot | None = None


@dataclass(frozen=True, slots=True)
class WhyNot:
    """Why a fact does not hold: an attempt for each rule that could derive it, those that come furthest first."""

    fact: Triple
    attempts: tuple[Attempt, ...]
    nearest: tuple[str, ...] = ()
