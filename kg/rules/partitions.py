"""Which rules infer everything from one part of a divided graph, and which need facts of several parts together.

A graph is divided by what its things belong to: a source with its launch files. Facts about things that no part owns
(topics, types, the ontologies) are copied to each part. A rule is local if its body can only match facts of one part:
all subjects of its atoms are one variable, or are joined by properties that never lead from one part to another.

Which properties do so is read from a store. So the answer holds for graphs like this one. Nothing
checks it again when the graph changes.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Final

from pyoxigraph import BlankNode, NamedNode, Quad

from kg.rules.form import Atom, EngineBlock, Pattern, Rule, is_auxiliary, readers_of
from kg.syntax.names import shorten

_TYPE: Final = "http://www.w3.org/1999/02/22-rdf-syntax-ns#type"
_Key = tuple[str, str]
"""A property, and for `rdf:type` the class; the other half is empty."""


@dataclass(frozen=True, slots=True)
class Parts:
    """What a store shows of the division of its graph, by property (and class).

    `owned` have subjects that a part owns. `inner` lead from these to things of the same part only, `outward` only to
    things that no part owns. `loose` are stated of things that no single part owns, by facts that are not copied.
    `only` have no other subjects than those that a part owns. `number` is how many parts there are.
    """

    number: int

    owned: frozenset[_Key]
    only: frozenset[_Key]
    inner: frozenset[_Key]
    outward: frozenset[_Key]
    loose: frozenset[_Key]


@dataclass(frozen=True, slots=True)
class Verdict:
    """Whether a rule, or a part of one, is local; `reason` is why not, empty if it is."""

    rule: Rule
    reason: str

    @property
    def is_local(self) -> bool:
        """Whether one part of the graph is enough."""
        return not self.reason


def parts_of(
    quads: Callable[[], Iterable[Quad]], part: Callable[[str, str], str | None], copied: frozenset[str]
) -> Parts:
    """Return the division that the quads of a store show; they are read twice.

    `part` gives the part that a graph and a subject in it belong to, None for what belongs to all; `copied` are the
    graphs that each part has.
    """
    owners: dict[object, str | None] = {}
    for quad in quads():
        own = part(_name(quad.graph_name), _name(quad.subject))
        if own is not None and owners.setdefault(quad.subject, own) != own:
            owners[quad.subject] = None  # several parts speak of it
    owned, loose, common, inside, outside, across = (set[_Key]() for _ in range(6))
    for quad in quads():
        key, owner = _key(quad.predicate, quad.object), owners.get(quad.subject)
        if _name(quad.graph_name) in copied:
            common.add(key)
            continue
        if owner is None:
            loose.add(key)
            continue
        owned.add(key)
        if quad.object not in owners:
            outside.add(key)
        elif owners[quad.object] == owner:
            inside.add(key)
        else:
            across.add(key)
    inner, outward = inside - outside - across, outside - inside - across
    number = len({own for own in owners.values() if own is not None})
    return Parts(
        number,
        frozenset(owned),
        frozenset(owned - loose - common),
        frozenset(inner),
        frozenset(outward),
        frozenset(loose),
    )


def verdicts(rules: Sequence[Rule], parts: Parts, asserted: Parts) -> list[Verdict]:
    """Return for each rule whether it is local, in the order given; `asserted` is what asserted facts alone show.

    What a rule infers from several parts may lead from one to another, whatever it does in the store at hand.
    """
    while True:
        result = [Verdict(rule, _reason(rule, {False: parts, True: asserted})) for rule in rules]
        doubtful = {_key_of(atom) for one in result if one.reason for atom in one.rule.head}
        certain = replace(
            parts,
            owned=parts.owned | doubtful,
            only=parts.only - doubtful,
            inner=parts.inner - doubtful,
            outward=parts.outward - doubtful,
        )
        if certain == parts:
            return result
        parts = certain


def _reason(rule: Rule, parts: Mapping[bool, Parts]) -> str:
    """Return why a rule is not local; `parts` by whether an atom reads asserted facts alone."""
    atoms: list[Atom] = []
    for element, _ in readers_of(rule.body):
        if isinstance(element, EngineBlock):
            return "a part of it is evaluated as a whole by the engine"
        if not isinstance(element.predicate, NamedNode):
            return "it matches any property"
        if is_auxiliary(element.predicate):
            return "it follows a path of any length"
        atoms.append(element)
    certain = {atom.subject for atom in atoms if _key_of(atom) in parts[atom.asserted].only}
    for atom in atoms:
        if atom.subject not in certain and _any(atom, parts[atom.asserted].loose):
            return f"`{_words(atom)}` is stated of things that no single source owns"
    shared = {atom.object for atom in atoms if _key_of(atom) in parts[atom.asserted].outward}
    owned = {
        atom.subject: atom for atom in atoms if _any(atom, parts[atom.asserted].owned) and atom.subject not in shared
    }
    if not owned:
        return ""
    links = [(atom.subject, atom.object) for atom in atoms if _key_of(atom) in parts[atom.asserted].inner]
    first = next(iter(owned))
    near = _together(first, links)
    apart = next((other for other in owned if not near & _together(other, links)), None)
    if apart is None:
        return ""
    ends = (f"{one} (`{_words(owned[one])}`)" for one in (first, apart))
    return f"{' and '.join(ends)} may belong to different sources"


def _together(start: Pattern, links: Sequence[tuple[Pattern, Pattern]]) -> set[Pattern]:
    """Return the terms that belong to the part of `start`, since properties within one part lead to them."""
    reached, waiting = {start}, [start]
    while waiting:
        one = waiting.pop()
        for ends in links:
            if one in ends:
                new = set(ends) - reached
                reached |= new
                waiting += new
    return reached


def _any(atom: Atom, keys: frozenset[_Key]) -> bool:
    """Return whether an atom may match one of the properties; a type that is not named may be any class."""
    key = _key_of(atom)
    return any(each[0] == _TYPE for each in keys) if key == (_TYPE, "") else key in keys


def _key_of(atom: Atom) -> _Key:
    return _key(atom.predicate, atom.object)


def _key(predicate: object, value: object) -> _Key:
    name = predicate.value if isinstance(predicate, NamedNode) else ""
    return name, value.value if name == _TYPE and isinstance(value, NamedNode) else ""


def _words(atom: Atom) -> str:
    predicate, kind = _key_of(atom)
    return shorten(kind or predicate)


def _name(graph: object) -> str:
    return graph.value if isinstance(graph, NamedNode | BlankNode) else ""
