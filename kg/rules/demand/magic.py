"""Magic sets: rules rewritten to derive only the triples that some goals need.

    rule       ?x :ancestor ?z  from  ?x :parent ?y . ?y :ancestor ?z
    goal       ?who :ancestor :a
    demand     (any) demand/fb/:ancestor :a        a triple that states which term is asked for
    rewritten  ?x :ancestor ?z  from  ?x :parent ?y . ?y :ancestor ?z . (any) demand/fb/:ancestor ?z

A predicate has a demand for each adornment: `b` for a bound subject or object, `f` for a free one. Demands are triples
of auxiliary predicates, so the semi-naive engine evaluates them like any others (Bancilhon, Maier, Sagiv and Ullman
1986; Beeri and Ramakrishnan 1991). Derived triples keep their predicate: each is true, whichever demand it answers.

A rule is evaluated whole, as it is written, where its answers cannot be restricted: it feeds a negation, an aggregate,
a block of SPARQL or a pattern with a variable as predicate; it counts, makes terms, or derives any predicate. The same
holds for the rules that it reads. Such rules read no demand, so rules that can be stratified still can.

Recursions that a demand for one end follows without answering every node on its way (Naughton et al. 1989).

    right   p(x, z) from  S(x, y), p(y, z)        composes what S relates before p
    left    p(x, z) from  p(x, y), S(y, z)        after it
    double  p(x, z) from  p(x, y), p(y, z)
    exit    any rule of p that does not recur

With demand for the subject, plain magic sets turn the right form into demand for every y that x reaches, so that all
pairs along a chain are derived where one end was asked for. Here the nodes reached are carried with x instead, and a
double rule becomes a left one: p(x, z) from p(x, y), exit(y, z). With demand for the object it is the other way round.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass, replace
from typing import Final, TypeAlias

from pyoxigraph import BlankNode, Literal, NamedNode, Triple

from kg.errors import Place
from kg.rules import form
from kg.rules.dependencies import Read, mints, reads
from kg.rules.stratify import Heads, edges
from kg.syntax.names import RDF_TYPE

Goal: TypeAlias = tuple[form.Atom | form.Values, ...]
"""Patterns and rows that a query joins: each pattern is asked for as far as the others bind it."""

_ANY: Final = NamedNode(f"{form.AUXILIARY}any")
"""Fills the free positions of a demand."""
_QUERY: Final = "query"
_X, _Y, _Z, _CARRIED = (form.Variable(name) for name in (".x", ".y", ".z", ".kept"))
_Demand: TypeAlias = tuple[NamedNode, str]
_Conjunct: TypeAlias = form.Atom | form.Values

_DOUBLE: Final = 2
"""How many atoms a double rule has."""


@dataclass(frozen=True, slots=True)
class Step:
    """A rule of the left or the right form: its head, the atom of the same predicate, and the atoms next to it."""

    rule: form.Rule
    head: form.Atom
    recursive: form.Atom
    nonrecursive: tuple[form.Atom, ...]


@dataclass(frozen=True, slots=True)
class Recursion:
    """The rules of a predicate, where each has one of the forms above; a double rule goes with exits alone."""

    predicate: NamedNode
    exits: tuple[tuple[form.Rule, form.Atom], ...]
    right: tuple[Step, ...]
    left: tuple[Step, ...]
    double: bool


def exit_of(predicate: NamedNode) -> NamedNode:
    """Return the predicate of the stored triples of a predicate and of the triples of its exits."""
    return NamedNode(f"{form.AUXILIARY}exit/{predicate.value}")


def recursion_of(
    predicate: NamedNode, rules: Sequence[form.Rule], recurs: Callable[[Sequence[form.Element]], bool]
) -> Recursion | None:
    """Return the rules of a predicate by their forms; None where one has another form, or none is recursive.

    `recurs` returns whether elements of a body read, directly or through other rules, what `rules` derive.
    """
    exits: list[tuple[form.Rule, form.Atom]] = []
    right: list[Step] = []
    left: list[Step] = []
    double = False
    for rule in rules:
        for head in (head for head in rule.head if head.predicate == predicate):
            if not recurs(rule.body):
                exits.append((rule, head))
            elif _is_double(head, rule.body):
                double = True
            elif (step := _step(rule, head, recurs)) is None:
                return None
            elif step.recursive.object == head.object:
                right.append(step)
            else:
                left.append(step)
    if double == bool(right or left):
        return None
    return Recursion(predicate, tuple(exits), tuple(right), tuple(left), double)


def _is_double(head: form.Atom, body: Sequence[form.Element]) -> bool:
    if len(body) != _DOUBLE:
        return False
    first, second = body
    if not (isinstance(first, form.Atom) and isinstance(second, form.Atom)) or first.asserted or second.asserted:
        return False
    if first.predicate != head.predicate or second.predicate != head.predicate:
        return False
    ends = {first.subject, first.object, second.object}
    chained = first.object == second.subject and (first.subject, second.object) == (head.subject, head.object)
    return chained and len(ends) == _DOUBLE + 1 and all(isinstance(end, form.Variable) for end in ends)


def _step(rule: form.Rule, head: form.Atom, recurs: Callable[[Sequence[form.Element]], bool]) -> Step | None:
    """Return a rule as one of the left or the right form."""
    atoms = [element for element in rule.body if isinstance(element, form.Atom)]
    recursive = [atom for atom in atoms if atom.predicate == head.predicate and not atom.asserted]
    if len(atoms) < len(rule.body) or len(recursive) != 1:
        return None
    (atom,) = recursive
    rest = tuple(other for other in atoms if other is not atom)
    if recurs(rest):
        return None
    if atom.object == head.object:
        fixed, others = head.object, (head.subject, atom.subject)
    elif atom.subject == head.subject:
        fixed, others = head.subject, (head.object, atom.object)
    else:
        return None
    used = {variable for other in rest for position in other.positions for variable in form.variables_of(position)}
    moved = {end for end in others if isinstance(end, form.Variable)}
    if not isinstance(fixed, form.Variable) or fixed in used or fixed in moved or not moved <= used:
        return None
    # What is carried becomes a subject, which a literal cannot be.
    if fixed == head.subject and atom.object not in {other.subject for other in rest}:
        return None
    return Step(rule, head, atom, rest)


@dataclass(frozen=True, slots=True)
class Rewritten:
    """Rules for some goals; `copies` are auxiliary predicates with the one whose stored triples each has to have."""

    rules: tuple[form.Rule, ...]
    copies: tuple[tuple[NamedNode, NamedNode], ...]


def demanded(rules: Iterable[form.Rule], goals: Iterable[Goal]) -> Rewritten:
    """Return rules that derive every triple that `rules` derive and that matches a pattern of `goals` within its goal.

    They may derive other triples that `rules` derive, and triples of auxiliary predicates. There are none where no rule
    is needed.
    """
    return _Rewriting(tuple(rules), tuple(goals)).rewritten()


class _Rewriting:
    """One set of rules, rewritten for some goals."""

    def __init__(self, rules: Sequence[form.Rule], goals: Sequence[Goal]) -> None:
        self._rules = rules
        self._goals = goals
        self._heads = Heads(rules)
        self._needs = needs = [set(need) for need in edges(rules)]
        atoms = [atom for goal in goals for atom in goal if isinstance(atom, form.Atom)]
        self._reached = _closed((number for atom in atoms for number in self._feeding(atom)), needs)
        self._whole = _closed(self._unrestricted(atoms), needs)
        self._rewritten: dict[tuple[str, int, form.Atom, tuple[form.Element, ...]], form.Rule] = {}
        self._demands: dict[_Demand, None] = {}
        self._recursions: dict[NamedNode, Recursion | None] = {}
        self._copies: dict[NamedNode, NamedNode] = {}

    def rewritten(self) -> Rewritten:
        """Return the rules rewritten."""
        for goal in self._goals:
            self._pass_on(goal, None)
        done: set[_Demand] = set()
        while len(done) < len(self._demands):
            for demand in [one for one in self._demands if one not in done]:
                done.add(demand)
                self._adorn(*demand)
        whole = (self._rules[number] for number in sorted(self._whole))
        return Rewritten((*whole, *self._rewritten.values()), tuple(self._copies.items()))

    def _feeding(self, atom: form.Atom) -> Iterator[int]:
        return iter(()) if atom.asserted else self._heads.matching(Read(atom, negated=False))

    def _unrestricted(self, atoms: Iterable[form.Atom]) -> Iterator[int]:
        """Yield the rules that are evaluated whole for a reason of their own."""
        for atom in atoms:
            if not isinstance(atom.predicate, NamedNode):
                yield from self._feeding(atom)
        for number in self._reached:
            rule = self._rules[number]
            if mints(rule) or _perhaps_unbound(rule.body) or not all(map(_simple, rule.head)):
                yield number
            restricted = {id(atom) for atom, _ in _atoms(rule.body) if isinstance(atom.predicate, NamedNode)}
            for read in reads(rule):
                if id(read.atom) not in restricted:
                    yield from self._heads.matching(read)

    def _adorn(self, predicate: NamedNode, adornment: str) -> None:
        """Rewrite each rule that answers a demand."""
        recursions = (one for one in self._recursions.values() if one and exit_of(one.predicate) == predicate)
        if recursion := next(recursions, None):
            self._adorn_exits(recursion, adornment)
        elif adornment in {"bf", "fb"} and (recursion := self._recursion(predicate)):
            self._adorn_recursion(recursion, adornment)
        else:
            for rule in self._deriving(predicate):
                for head in rule.head:
                    if head.predicate == predicate:
                        self._adorn_rule(rule, head, adornment)

    def _deriving(self, predicate: NamedNode) -> list[form.Rule]:
        every = (self._rules[number] for number in sorted(self._reached - self._whole))
        return [rule for rule in every if any(head.predicate == predicate for head in rule.head)]

    def _adorn_rule(self, rule: form.Rule, head: form.Atom, adornment: str) -> None:
        demand = _demand(head, adornment)
        self._add(replace(rule, head=(head,), body=(*rule.body, demand)))
        # What binds variables: atoms, those of positive EXISTS too, and rows.
        rows = (element for element in rule.body if isinstance(element, form.Values))
        self._pass_on([*(atom for _, atom in _atoms(rule.body)), *rows], demand)

    def _recursion(self, predicate: NamedNode) -> Recursion | None:
        """Return the rules of a predicate, where all have the forms of a recursion."""
        if predicate not in self._recursions:
            rules = self._deriving(predicate)
            own = {number for number, rule in enumerate(self._rules) if rule in rules}

            def recurs(body: Sequence[form.Element]) -> bool:
                read = reads(form.Rule(_QUERY, (), tuple(body), Place(_QUERY)))
                feeding = (number for one in read for number in self._heads.matching(one))
                return not own.isdisjoint(_closed(feeding, self._needs))

            anywhere = any(head.predicate == predicate for number in self._whole for head in self._rules[number].head)
            self._recursions[predicate] = None if anywhere else recursion_of(predicate, rules, recurs)
        return self._recursions[predicate]

    def _adorn_exits(self, recursion: Recursion, adornment: str) -> None:
        """Rewrite the exits of a recursion: stored triples, and rules that do not recur."""
        exits, copy = exit_of(recursion.predicate), NamedNode(f"{form.AUXILIARY}stored/{recursion.predicate.value}")
        self._copies[copy] = recursion.predicate
        head = form.Atom(_X, exits, _Z)
        self._add(form.Rule(_QUERY, (head,), (form.Atom(_X, copy, _Z), _demand(head, adornment)), Place(_QUERY)))
        for rule, derived in recursion.exits:
            self._adorn_rule(rule, replace(derived, predicate=exits), adornment)

    def _adorn_recursion(self, recursion: Recursion, adornment: str) -> None:
        """Rewrite a recursion for demand of one end: steps at that end carry it, others add to what is derived."""
        forward = adornment == "bf"
        head, end = form.Atom(_X, recursion.predicate, _Z), exit_of(recursion.predicate)
        demand = _demand(head, adornment)
        self._answer(head, (), form.Atom(_X, end, _Z), demand, adornment)
        if recursion.double:
            first = form.Atom(_X, recursion.predicate, _Y) if forward else form.Atom(_Y, recursion.predicate, _Z)
            last = form.Atom(_Y, end, _Z) if forward else form.Atom(_X, end, _Y)
            self._answer(head, (first,), last, demand, adornment)
        near, far = (recursion.right, recursion.left) if forward else (recursion.left, recursion.right)
        for step in far:
            self._adorn_rule(step.rule, step.head, adornment)
        # Relates an end asked for to the nodes that its steps reach.
        via = NamedNode(f"{form.AUXILIARY}via/{adornment}/{recursion.predicate.value}")
        for step in near:
            here, there = (
                (step.head.subject, step.recursive.subject) if forward else (step.head.object, step.recursive.object)
            )
            for start in (
                _demand(step.head, adornment),
                form.Atom(_CARRIED, via, here) if forward else form.Atom(here, via, _CARRIED),
            ):
                # The end asked for is the step's own, or the one that an earlier step carried here.
                carried = _CARRIED if start.predicate == via else here
                reached = form.Atom(carried, via, there) if forward else form.Atom(there, via, carried)
                self._add(replace(step.rule, head=(reached,), body=(*step.nonrecursive, start)))
                self._pass_on(step.nonrecursive, start)
        if near:
            passed = form.Atom(_X, via, _Y) if forward else form.Atom(_Y, via, _Z)
            self._answer(head, (), form.Atom(_Y, end, _Z) if forward else form.Atom(_X, end, _Y), passed, adornment)

    def _answer(
        self, head: form.Atom, before: tuple[form.Atom, ...], last: form.Atom, start: form.Atom, adornment: str
    ) -> None:
        """Add the rule that derives `head` from atoms of which the last one is asked for as far as they bind it."""
        self._add(form.Rule(_QUERY, (head,), (*before, last, start), Place(_QUERY)))
        if isinstance(last.predicate, NamedNode):
            self._demands[last.predicate, adornment] = None
        self._add(form.Rule(_QUERY, (_demand(last, adornment),), (*before, start), Place(_QUERY)))

    def _pass_on(self, conjuncts: Sequence[_Conjunct], start: form.Atom | None) -> None:
        """Demand what each atom of a body can add, where the demand `start` and other atoms bind variables of it."""
        remaining = list(conjuncts)
        bound = set(_variables(start)) if start else set()
        before: list[_Conjunct] = []
        while remaining:
            number = min(range(len(remaining)), key=lambda index: self._rank(remaining[index], bound))
            chosen = remaining.pop(number)
            if isinstance(chosen, form.Atom) and self._derived(chosen):
                self._demand_for(chosen, bound, before, start)
            before.append(chosen)
            bound |= set(_variables(chosen))

    def _demand_for(
        self, atom: form.Atom, bound: set[form.Variable], before: Sequence[_Conjunct], start: form.Atom | None
    ) -> None:
        """Add the rule that passes demand on to an atom."""
        if isinstance(atom.subject, Literal | Triple) or not isinstance(atom.predicate, NamedNode):
            return
        adornment = "".join("b" if _bound(end, bound) else "f" for end in (atom.subject, atom.object))
        self._demands[atom.predicate, adornment] = None
        head = _demand(atom, adornment)
        body: tuple[form.Element, ...] = _connected(head, before)
        body = (start, *body) if start else body
        if head not in body:
            self._add(form.Rule(_QUERY, (head,), body, Place(_QUERY)))

    def _add(self, rule: form.Rule) -> None:
        self._rewritten.setdefault((rule.name, rule.part, rule.head[0], rule.body), rule)

    def _derived(self, atom: form.Atom) -> bool:
        return any(number not in self._whole for number in self._feeding(atom))

    def _rank(self, element: _Conjunct, bound: set[form.Variable]) -> tuple[int, int]:
        """Return the place of an element in the order in which bindings are passed on; the least comes first.

        What is joined with variables known so far comes before what a constant restricts; of these two stored triples
        come before derived ones where they are joined, and after them where only a constant restricts them.
        """
        joined = len(bound.intersection(_variables(element)))
        if isinstance(element, form.Values):
            return (0 if joined else 3), -joined
        derived = self._derived(element)
        if joined:
            return int(derived), -joined - _constants(element)
        if _constants(element):
            return (2 if derived else 3), -_constants(element)
        return 4 + derived, 0


def _closed(numbers: Iterable[int], needs: Sequence[set[int]]) -> set[int]:
    """Return some rules with all those that they read, directly or through others."""
    reached: set[int] = set()
    pending = list(numbers)
    while pending:
        number = pending.pop()
        if number not in reached:
            reached.add(number)
            pending += needs[number]
    return reached


def _simple(head: form.Atom) -> bool:
    """Return whether demand can be stated for a head: for its predicate, and for terms and variables at its ends."""
    return isinstance(head.predicate, NamedNode) and not any(
        isinstance(end, form.TripleTerm | BlankNode) for end in (head.subject, head.object)
    )


def _perhaps_unbound(body: tuple[form.Element, ...]) -> bool:
    """Return whether a solution may leave a variable unbound: a demand would bind it to what is asked for."""
    return any(isinstance(one, form.Aggregate) or (isinstance(one, form.EngineBlock) and one.optional) for one in body)


def _demand(atom: form.Atom, adornment: str) -> form.Atom:
    """Return the triple that states a demand for an atom."""
    subject, value = (
        end if letter == "b" else _ANY for end, letter in zip((atom.subject, atom.object), adornment, strict=True)
    )
    predicate = atom.predicate.value if isinstance(atom.predicate, NamedNode) else ""
    return form.Atom(subject, NamedNode(f"{form.AUXILIARY}demand/{adornment}/{predicate}"), value)


def _bound(end: form.Pattern, bound: set[form.Variable]) -> bool:
    # In a head, a blank node would be a new one.
    return end in bound if isinstance(end, form.Variable) else not isinstance(end, form.TripleTerm | BlankNode)


def _constants(atom: form.Atom) -> int:
    """Count the ends that are terms; a class restricts little."""
    ends = (atom.subject,) if atom.predicate == RDF_TYPE else (atom.subject, atom.object)
    return sum(not isinstance(end, form.Variable | form.TripleTerm) for end in ends)


def _variables(element: _Conjunct) -> Iterator[form.Variable]:
    if isinstance(element, form.Values):
        yield from element.variables
        return
    for position in element.positions:
        yield from form.variables_of(position)


def _connected(head: form.Atom, elements: Sequence[_Conjunct]) -> tuple[_Conjunct, ...]:
    """Return the elements that restrict the variables of a head, directly or through others, in their order."""
    reached = set(_variables(head))
    chosen: set[int] = set()
    grown = bool(reached)
    while grown:
        grown = False
        for index, element in enumerate(elements):
            if index not in chosen and reached.intersection(_variables(element)):
                chosen.add(index)
                reached |= set(_variables(element))
                grown = True
    return tuple(elements[index] for index in sorted(chosen))


def _atoms(
    body: tuple[form.Element, ...], names: dict[form.Variable, form.Variable] | None = None, mark: str = ""
) -> Iterator[tuple[form.Atom, form.Atom]]:
    """Yield the atoms that a body joins, each also with the variables that only an EXISTS has renamed apart."""
    names = dict(names or {})
    for index, element in enumerate(body):
        if isinstance(element, form.Atom):
            yield element, element.replaced({each: _name(each, names, mark) for each in form.binds(element)})
        elif isinstance(element, form.Exists) and not element.negated:
            outer = {variable: _name(variable, names, mark) for variable in {*names, *form.bound_in(body[:index])}}
            yield from _atoms(element.body, outer, f"{mark} {index}")


def _name(variable: form.Variable, names: dict[form.Variable, form.Variable], mark: str) -> form.Variable:
    return names.get(variable) or (form.Variable(f"{variable.name}{mark}") if mark else variable)
