"""Paths of any length, which decomposition turned into auxiliary predicates, as triples of the store.

A rule with `:p+` reads an auxiliary predicate that a store never holds. For queries it is written as the path again;
in a proof the triples of a shortest way from one end to the other stand for it.
"""

from __future__ import annotations

from collections import deque
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, Final

from pyoxigraph import NamedNode, Triple

from kg.rules import sparql
from kg.rules.form import Aggregate, Atom, Element, EngineBlock, Exists, Pattern, Rule, Term, Variable, is_auxiliary

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Mapping, Sequence

    Bodies = Mapping[str, tuple[tuple[Element, ...], ...]]
    Stepper = Callable[[tuple[Element, ...], Term], Iterable[tuple[Term, tuple[Triple, ...]]]]

_FROM: Final = Variable(".from")
_MOST_STEPS: Final = 20_000


@dataclass(frozen=True, slots=True)
class Closures:
    """The auxiliary predicates of a rule set: for each the bodies of one step, from `.from` to `.to`."""

    steps: Bodies = field(default_factory=dict)

    @classmethod
    def of(cls, rules: Iterable[Rule]) -> Closures:
        """Return those that some rules derive."""
        by_name: dict[str, dict[tuple[Element, ...], None]] = {}
        for rule in rules:
            for head in rule.head:
                if is_auxiliary(head.predicate):
                    bodies = by_name.setdefault(head.predicate.value, {})
                    if all(atom.predicate != head.predicate for atom in rule.body if isinstance(atom, Atom)):
                        bodies[rule.body] = None
        return cls({name: tuple(bodies) for name, bodies in by_name.items()})

    def written(self, body: Sequence[Element]) -> tuple[Element, ...]:
        """Return a body with each auxiliary atom as a path of SPARQL."""
        return tuple(map(self._element, body))

    def _element(self, element: Element) -> Element:
        if isinstance(element, Atom) and is_auxiliary(element.predicate):
            path = self._path(element.predicate.value)
            ends = (element.subject, element.object)
            text = f"{sparql.term(ends[0])} {path} {sparql.term(ends[1])} ."
            return EngineBlock(text, tuple(end for end in ends if isinstance(end, Variable)), place=element.place)
        if isinstance(element, Exists | Aggregate):
            return replace(element, body=self.written(element.body))
        return element

    def _path(self, name: str) -> str:
        ways = "|".join(self._way(body) for body in self.steps.get(name, ()))
        return f"({ways})+" if ways else f"<{name}>"

    def _way(self, body: tuple[Element, ...]) -> str:
        """Return one step as a path: its atoms follow one another from `.from` to `.to`."""
        here: Pattern = _FROM
        parts = []
        for element in body:
            if not isinstance(element, Atom):
                continue
            forward = element.subject == here
            part = self._link(element.predicate, body)
            parts.append(part if forward else f"^{part}")
            here = element.object if forward else element.subject
        return "/".join(parts)

    def _link(self, predicate: Pattern, body: tuple[Element, ...]) -> str:
        if isinstance(predicate, NamedNode):
            return self._path(predicate.value) if is_auxiliary(predicate) else str(predicate)
        # A predicate that may be any but some: the filter behind the atom names these.
        texts = [each.expression.text for each in body if hasattr(each, "expression")]
        named = next((text for text in texts if text.startswith(sparql.term(predicate))), "")
        return f"!({named[named.find('(') + 1 : -1].replace(', ', '|')})" if named else "(<urn:kg:any>|!<urn:kg:any>)"

    def way(self, name: str, start: Term, end: Term, step: Stepper) -> tuple[Triple, ...]:
        """Return the triples of a shortest way from `start` to `end`; `step` yields what one step leads to.

        Empty when there is none, or when it is not found among the first 20,000 ends of steps.
        """
        came: dict[Term, tuple[Term, tuple[Triple, ...]]] = {}
        waiting = deque([start])
        while waiting and len(came) < _MOST_STEPS:
            here = waiting.popleft()
            for body in self.steps.get(name, ()):
                for there, facts in step(body, here):
                    if there not in came:
                        came[there] = (here, facts)
                        waiting.append(there)
            if end in came:
                here, facts = came[end]
                path = [facts]
                while here != start:
                    here, facts = came[here]
                    path.append(facts)
                return tuple(fact for part in reversed(path) for fact in part)
        return ()
