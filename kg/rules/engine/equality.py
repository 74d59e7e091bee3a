"""Rules that make a predicate an equality, evaluated by classes of equal terms.

    ?x E ?y -> ?y E ?x                      symmetry
    ?x E ?y . ?y E ?z -> ?x E ?z            transitivity
    ?x E ?t . ?x ?p ?o -> ?t ?p ?o          replacement of the subject; also of the predicate and of the object

Evaluated one by one, each of these joins all pairs of a class with all its terms, which is cubic. A `Closure` keeps the
classes and derives the same triples in time linear in their number. The rules are recognised by their form.
"""

from __future__ import annotations

from collections import Counter
from dataclasses import dataclass
from itertools import permutations
from typing import TYPE_CHECKING, Final

import numpy as np
from pyoxigraph import NamedNode

from kg.rules.engine.facts import EMPTY, Facts, Keys, difference, distinct, flipped, pack, union, unpack
from kg.rules.engine.terms import BLANK, IRI, Dictionary
from kg.rules.form import Atom, Rule, Variable

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Sequence

    from numpy.typing import NDArray


_SUBJECT, _PREDICATE, _OBJECT = range(3)
_ATOMS: Final = 2


@dataclass(frozen=True, slots=True)
class Equality:
    """The rules that make `predicate` an equality; `replacing` has those that replace subject, predicate, object."""

    predicate: NamedNode
    symmetry: tuple[Rule, ...]
    transitivity: tuple[Rule, ...]
    replacing: tuple[tuple[Rule, ...], tuple[Rule, ...], tuple[Rule, ...]]

    @property
    def rules(self) -> frozenset[Rule]:
        """All of them."""
        return frozenset((*self.symmetry, *self.transitivity, *(rule for each in self.replacing for rule in each)))


def equalities(rules: Iterable[Rule]) -> tuple[Equality, ...]:
    """Return the predicates that some rules make symmetric and transitive, with the rules that replace equal terms."""
    roles: dict[tuple[NamedNode, str | int], list[Rule]] = {}
    for rule in rules:
        role = _role(rule)
        if role is not None:
            roles.setdefault(role, []).append(rule)

    def of(predicate: NamedNode, role: str | int) -> tuple[Rule, ...]:
        return tuple(roles.get((predicate, role), ()))

    return tuple(
        Equality(
            predicate,
            of(predicate, "symmetry"),
            of(predicate, "transitivity"),
            (of(predicate, _SUBJECT), of(predicate, _PREDICATE), of(predicate, _OBJECT)),
        )
        for predicate, role in roles
        if role == "symmetry" and (predicate, "transitivity") in roles
    )


def _role(rule: Rule) -> tuple[NamedNode, str | int] | None:
    """Return the predicate that a rule is about, and what the rule does; None for a rule of another form."""
    atoms = [atom for atom in rule.body if isinstance(atom, Atom) and not atom.asserted]
    if len(rule.head) != 1 or len(atoms) != len(rule.body) or len(atoms) not in {1, _ATOMS}:
        return None
    head = rule.head[0]
    if len(atoms) == 1:
        (atom,) = atoms
        if isinstance(atom.predicate, NamedNode) and _variables(atom.subject, atom.object):
            reversed_ = (atom.object, atom.predicate, atom.subject)
            return (atom.predicate, "symmetry") if head.positions == reversed_ else None
        return None
    for equal, other in permutations(atoms):
        if not (isinstance(equal.predicate, NamedNode) and _variables(equal.subject, equal.object)):
            continue
        if (
            other.predicate == equal.predicate
            and other.subject == equal.object
            and _variables(equal.subject, equal.object, other.object)
            and head.positions == (equal.subject, equal.predicate, other.object)
        ):
            return equal.predicate, "transitivity"
        if not _variables(equal.object, *other.positions):
            continue
        for place, term in enumerate(other.positions):
            replaced = (*other.positions[:place], equal.object, *other.positions[place + 1 :])
            if term == equal.subject and head.positions == replaced:
                return equal.predicate, place
    return None


def _variables(*patterns: object) -> bool:
    """Tell whether patterns are different variables."""
    return all(isinstance(one, Variable) for one in patterns) and len(set(patterns)) == len(patterns)


class Closure:
    """One equality in one evaluation; `derived` counts the triples that each of its rules was the first to derive."""

    def __init__(self, equality: Equality, dictionary: Dictionary, hidden: frozenset[int]) -> None:
        self.equality = equality
        self.derived: Counter[Rule] = Counter()
        self.pairs = 0
        """How many pairs of equal terms there were among the triples."""
        self._dictionary = dictionary
        self._hidden = hidden
        self._predicate = dictionary.intern_term(equality.predicate)
        self._classes = _Classes(dictionary)

    def close(self, parts: Sequence[Facts], fresh: Sequence[Facts], allow: Callable[[int], None]) -> Facts:
        """Return what the rules derive and none of `parts` contains.

        `parts` are all triples; `fresh` are those of them that no earlier call received or returned. `allow` receives
        a lower bound of the number of triples to return before these are made, and raises where that is too many.
        """
        result = Facts()
        self.pairs += sum(facts.keys(self._predicate).size for facts in fresh)
        while fresh:
            new = self._step([*parts, result], fresh, lambda least: allow(len(result) + least))
            for predicate, keys in new:
                result.extend(predicate, keys)
            # Only the replacement of a predicate makes further terms equal; all else is complete after one step.
            again = new.keys(self._predicate).size and self._replaces(_PREDICATE, self._predicate)
            fresh = [new] if again else []
        self.pairs += result.keys(self._predicate).size
        return result

    def _step(self, parts: Sequence[Facts], fresh: Sequence[Facts], allow: Callable[[int], None]) -> Facts:
        """Return what follows from the classes that the triples give."""
        changed = self._classes.merge(np.concatenate([facts.keys(self._predicate) for facts in fresh]))
        result = Facts()
        if not self._classes:
            return result
        for predicate in sorted(frozenset[int]().union(*(facts.predicates for facts in parts))):
            keys = self._affected(predicate, parts, fresh, changed)
            if keys.size:
                self._replace(predicate, keys, [*parts, result], allow)
        return result

    def _replaces(self, position: int, predicate: int) -> bool:
        """Check whether rules replace terms in a position of the triples of a predicate."""
        if position != _PREDICATE and predicate == self._predicate:
            return True
        if not self.equality.replacing[position] or predicate in self._hidden:
            return False
        return position != _PREDICATE or bool(self._classes.has(np.array([predicate]))[0])

    def _affected(self, predicate: int, parts: Sequence[Facts], fresh: Sequence[Facts], changed: Keys) -> Keys:
        """Return the pairs of a predicate that may give others: fresh ones, and those of terms in changed classes."""
        predicates = self._replaces(_PREDICATE, predicate)
        if predicates and predicate in changed:
            return union(*(facts.keys(predicate) for facts in parts))
        subjects, objects = (self._replaces(position, predicate) for position in (_SUBJECT, _OBJECT))
        pieces = [EMPTY]
        for facts in fresh:
            keys = facts.keys(predicate)
            affected = np.full(keys.size, predicates)
            for end, replaced in zip(unpack(keys), (subjects, objects), strict=True):
                if replaced:
                    affected |= self._classes.has(end)
            pieces.append(keys[affected])
        for facts in parts if changed.size else ():
            if subjects:
                pieces.append(_ranges(facts.keys(predicate), changed)[0])
            if objects:
                pieces.append(flipped(_ranges(facts.by_object(predicate), changed)[0]))
        return distinct(np.concatenate(pieces))

    def _replace(self, predicate: int, keys: Keys, parts: Sequence[Facts], allow: Callable[[int], None]) -> None:
        """Add to the last of `parts` what pairs of a predicate give, position by position."""
        result = parts[-1]
        for position in (_SUBJECT, _OBJECT):
            if not self._replaces(position, predicate):
                continue
            folded = self._classes.folded(keys if position == _SUBJECT else flipped(keys))
            least = self._classes.least(folded)
            allow(len(result) + least - sum(facts.keys(predicate).size for facts in parts))
            keys = self._classes.spread(folded, values=position == _OBJECT)
            keys = keys if position == _SUBJECT else flipped(keys)
            if position == _OBJECT or predicate != self._predicate:
                self._add(predicate, keys, position, parts)
        if self._replaces(_PREDICATE, predicate):
            for other in self._classes.terms(predicate).tolist():
                if other != predicate and self._dictionary.kinds(np.array([other]))[0] == IRI:
                    self._add(other, keys, _PREDICATE, parts)

    def _add(self, predicate: int, keys: Keys, position: int, parts: Sequence[Facts]) -> None:
        new = keys
        for facts in parts:
            new = facts.missing(predicate, new)
        if predicate == self._predicate and position != _PREDICATE:
            turned = flipped(new)
            for facts in parts:
                turned = facts.missing(predicate, turned)
            self.derived[self.equality.symmetry[0]] += new.size - turned.size
            self.derived[self.equality.transitivity[0]] += turned.size
        else:
            self.derived[self.equality.replacing[position][0]] += new.size
        parts[-1].extend(predicate, new)


class _Classes:
    """Classes of equal terms; each has the number of its least term.

    A literal or a triple term cannot be a subject, so nothing follows from what is equal to it: a value of its class.
    """

    def __init__(self, dictionary: Dictionary) -> None:
        self._dictionary = dictionary
        self._class = EMPTY
        """The class of each term, by number; terms without equals are classes of their own."""
        self._equal = np.zeros(0, bool)
        """Which terms are equal to another term or to a value."""
        self._terms = EMPTY
        """These terms, sorted."""
        self._members = EMPTY
        """Sorted pairs of a class and a term of it."""
        self._values = EMPTY
        """Sorted pairs of a class and a value of it."""
        self._all = EMPTY
        """Both."""

    def __bool__(self) -> bool:
        return bool(self._terms.size)

    def merge(self, pairs: Keys) -> Keys:
        """Register pairs of equal terms. Return the terms, sorted, of all classes that changed."""
        self._grow()
        left, right = unpack(pairs)
        kinds = self._dictionary.kinds(right)
        resource = (kinds == IRI) | (kinds == BLANK)
        ends = self._class[left[resource]], self._class[right[resource]]
        joins = distinct(pack(np.minimum(*ends), np.maximum(*ends))[ends[0] != ends[1]])
        values = difference(distinct(pack(self._class[left[~resource]], right[~resource])), self._values)
        if not joins.size and not values.size:
            return EMPTY
        changed = distinct(np.concatenate([*unpack(joins), values >> 32]))
        self._terms = union(self._terms, changed)
        self._equal[changed] = True
        if joins.size:
            self._join(joins)
        owners, literals = unpack(union(self._values, values))
        self._values = distinct(pack(self._class[owners], literals))
        self._members = np.sort(pack(self._class[self._terms], self._terms))
        self._all = union(self._members, self._values)
        return np.sort(unpack(_ranges(self._members, distinct(self._class[changed]))[0])[1])

    def _grow(self) -> None:
        """Make room for all terms of the dictionary, and for some more."""
        before, size = self._class.size, len(self._dictionary)
        if before < size:
            size = size * 5 // 4
            self._class = np.concatenate([self._class, np.arange(before, size)])
            self._equal = np.concatenate([self._equal, np.zeros(size - before, bool)])

    def _join(self, pairs: Keys) -> None:
        """Make one class of all that pairs of classes connect: each takes the least neighbour, until none is less."""
        names = distinct(np.concatenate(unpack(pairs)))
        left, right = (np.searchsorted(names, end) for end in unpack(pairs))
        label = np.arange(names.size)
        while left.size:
            ends = label[left], label[right]
            np.minimum.at(label, np.maximum(*ends), np.minimum(*ends))
            while not np.array_equal(label, shorter := label[label]):
                label = shorter
            apart = label[left] != label[right]
            left, right = left[apart], right[apart]
        self._class[names] = names[label]
        # The other terms of the classes follow the term that names theirs.
        self._class[self._terms] = self._class[self._class[self._terms]]

    def has(self, terms: Keys) -> NDArray[np.bool_]:
        """Check for each term whether it is equal to another term or to a value."""
        self._grow()
        return self._equal[terms]

    def terms(self, term: int) -> Keys:
        """Return the terms of the class of one that is equal to another."""
        return unpack(_ranges(self._members, self._class[[term]])[0])[1]

    def folded(self, keys: Keys) -> Keys:
        """Return pairs with the class of each first term instead of it, sorted, each once."""
        self._grow()
        first, second = unpack(keys)
        return distinct(pack(self._class[first], second))

    def least(self, folded: Keys) -> int:
        """Return how many pairs `spread` gives at least."""
        begin, end = _bounds(self._members, folded >> 32)
        return int(np.maximum(end - begin, 1).sum())

    def spread(self, folded: Keys, *, values: bool) -> Keys:
        """Return pairs with each term of a class instead of the class, and with `values` each value of it."""
        places, source = _ranges(self._all if values else self._members, folded >> 32)
        alone = folded[~self.has(folded >> 32)]
        return distinct(np.concatenate([alone, pack(unpack(places)[1], unpack(folded)[1][source])]))


def _bounds(pairs: Keys, firsts: Keys) -> tuple[Keys, Keys]:
    """Return where the pairs of each first term begin and end."""
    return np.searchsorted(pairs, firsts << 32), np.searchsorted(pairs, (firsts + 1) << 32)


def _ranges(pairs: Keys, firsts: Keys) -> tuple[Keys, Keys]:
    """Return the sorted pairs that have each first term, and for each of them which of the first terms it has."""
    begin, end = _bounds(pairs, firsts)
    counts = end - begin
    source = np.repeat(np.arange(firsts.size), counts)
    shift = begin - (np.cumsum(counts) - counts)
    return pairs[np.arange(source.size) + shift[source]], source
