"""Strata: the order in which rules run. Negation and aggregates see only finished predicates.

Each is evaluated in parts, the strongly connected components of the rules' dependencies: rules that feed each other run
together to a fixpoint, any other rule runs once; that is what `Stratum` holds. Its `level` is the stratum in the sense
of the field (Apt, Blair, Walker, "Towards a theory of declarative knowledge", 1988): one more than that of what it
negates or counts, and not below that of what it reads. Dependencies decide the order. `sh:order` decides where they
leave it open: of the rules that may run next, one of the lowest order does. So a rule of a lower order is finished
before one of a higher order unless it reads, directly or through others, what that one derives; it then sees the whole
fixpoint, where an evaluation in a single pass (SHACL-AF, section 8) would miss a part of it.
"""

from __future__ import annotations

import heapq
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import Final

from pyoxigraph import NamedNode

from kg.errors import RuleError
from kg.render.text import some
from kg.rules.dependencies import Read, depends, mints, reads
from kg.rules.form import Atom, Rule, Variable
from kg.syntax.names import shorten

_FEW: Final = 5
"""So many rules of a cycle are named where it is enough to see that there is one."""

_LIMITED: Final = "Move what makes terms to a rule of its own, or set a limit."
_ANY_PROPERTY: Final = (
    "Rules that derive any property, such as eq-rep-p of owl-rl, feed every other rule: families that make terms "
    "or deny something cannot be combined with owl-rl. `rule_families` names those that go together."
)


@dataclass(frozen=True, slots=True)
class Stratum:
    """Rules that are evaluated together; `number` counts from one; `recursive`: one of them feeds itself.

    `level` is one for rules that neither negate nor count what rules derive, nor read what rules derive that do.
    """

    number: int
    rules: tuple[Rule, ...]
    recursive: bool
    level: int = 1


@dataclass(frozen=True, slots=True)
class Failure:
    """One reason why rules have no order: `rule` has the error, `cycle` are all rules that are part of it."""

    error: RuleError
    rule: Rule
    cycle: tuple[Rule, ...]


def stratify(rules: Iterable[Rule], *, bounded: bool = False) -> list[Stratum]:
    """Return the rules in strata, in the order in which they run.

    Raises `RuleError`: KG202 where a rule depends on its own negation or aggregate (SPARQL 1.2 RL, stratification),
    KG204 where a rule that mints terms feeds itself; `bounded` lets it pass, for runs that have a limit.
    """
    ordered = list(rules)
    needs = edges(ordered)
    strata: list[Stratum] = []
    levels = [1] * len(ordered)
    for component in _in_order(ordered, needs):
        level = max(
            (levels[need] + read.negated for rule in component for need, read in needs[rule].items()), default=1
        )
        for rule in component:
            levels[rule] = level
        failure = next(_failures(ordered, needs, component, bounded=bounded), None)
        if failure is not None:
            raise failure.error
        members = tuple(ordered[rule] for rule in sorted(component))
        strata.append(Stratum(len(strata) + 1, members, _feeds_itself(needs, component), level))
    return strata


def failures(rules: Iterable[Rule]) -> Iterator[Failure]:
    """Yield every reason why rules cannot be put in order, where `stratify` raises the first.

    Each cycle comes once, and so does each pattern that is denied.
    """
    ordered = list(rules)
    needs = edges(ordered)
    for component in _in_order(ordered, needs):
        yield from _failures(ordered, needs, component, bounded=False)


def _feeds_itself(needs: list[dict[int, Read]], component: list[int]) -> bool:
    members = set(component)
    return any(need in members for rule in component for need in needs[rule])


def _failures(
    rules: Sequence[Rule], needs: list[dict[int, Read]], component: list[int], *, bounded: bool
) -> Iterator[Failure]:
    """Yield the problems of one component; only one that feeds itself has any."""
    if _feeds_itself(needs, component):
        yield from _negations(rules, needs, component)
        if not bounded:
            yield from _mintings(rules, needs, component)


def edges(rules: Sequence[Rule]) -> list[dict[int, Read]]:
    """Return for each rule those whose heads it reads, with the atom that does; a negated one if any."""
    heads = Heads(rules)
    result: list[dict[int, Read]] = []
    for rule in rules:
        needs: dict[int, Read] = {}
        for read in reads(rule):
            for writer in heads.matching(read):
                if writer not in needs or (read.negated and not needs[writer].negated):
                    needs[writer] = read
        result.append(needs)
    return result


class Heads:
    """The heads of rules by predicate, to avoid trying every pair."""

    def __init__(self, rules: Sequence[Rule]) -> None:
        self._all: list[tuple[int, Atom]] = []
        self._variable: list[tuple[int, Atom]] = []
        self._by_predicate: dict[NamedNode, list[tuple[int, Atom]]] = {}
        self._by_object: dict[tuple[NamedNode, NamedNode | None], list[tuple[int, Atom]]] = {}
        for number, rule in enumerate(rules):
            for head in rule.head:
                self._all.append((number, head))
                if isinstance(head.predicate, NamedNode):
                    self._by_predicate.setdefault(head.predicate, []).append((number, head))
                    fixed = head.object if isinstance(head.object, NamedNode) else None
                    self._by_object.setdefault((head.predicate, fixed), []).append((number, head))
                else:
                    self._variable.append((number, head))

    def matching(self, read: Read) -> Iterator[int]:
        """Yield the numbers of the rules that derive what a body reads."""
        candidates: Iterable[tuple[int, Atom]] = self._all
        predicate, value = read.atom.predicate, read.atom.object
        if isinstance(predicate, NamedNode) and isinstance(value, NamedNode):
            # Most rules of a schema give a class: those that give another one are not even compared.
            same, unknown = (self._by_object.get((predicate, fixed), ()) for fixed in (value, None))
            candidates = [*same, *unknown, *self._variable]
        elif isinstance(predicate, NamedNode):
            candidates = [*self._by_predicate.get(predicate, ()), *self._variable]
        return (
            number for number, head in candidates if head.predicate not in read.excluded and depends(read.atom, head)
        )


def _components(needs: Sequence[Sequence[int]]) -> list[list[int]]:
    """Return the strongly connected components (Tarjan 1972, without recursion: chains of rules may be long)."""
    index: dict[int, int] = {}
    low: dict[int, int] = {}
    stack: list[int] = []
    waiting: set[int] = set()
    components: list[list[int]] = []
    for root in range(len(needs)):
        path = [] if root in index else [(root, iter(needs[root]))]
        while path:
            node, following = path[-1]
            if node not in index:
                index[node] = low[node] = len(index)
                stack.append(node)
                waiting.add(node)
            unseen = None
            for need in following:
                if need not in index:
                    unseen = need
                    break
                if need in waiting:
                    low[node] = min(low[node], index[need])
            if unseen is not None:
                path.append((unseen, iter(needs[unseen])))
                continue
            path.pop()
            if path:
                low[path[-1][0]] = min(low[path[-1][0]], low[node])
            if low[node] == index[node]:
                components.append(_popped(stack, waiting, node))
    return components


def _popped(stack: list[int], waiting: set[int], node: int) -> list[int]:
    """Take a component, down to the node that was reached first, from the stack."""
    component: list[int] = []
    while not component or component[-1] != node:
        component.append(stack.pop())
        waiting.discard(component[-1])
    return component


def _in_order(rules: Sequence[Rule], needs: list[dict[int, Read]]) -> Iterator[list[int]]:
    """Yield the components after those that they read; among those that are ready, the lowest `sh:order` first."""
    components = _components([sorted(need) for need in needs])
    home = {rule: number for number, component in enumerate(components) for rule in component}
    missing: list[set[int]] = [set() for _ in components]
    readers: list[set[int]] = [set() for _ in components]
    for rule, need in enumerate(needs):
        for writer in need:
            if home[writer] != home[rule]:
                missing[home[rule]].add(home[writer])
                readers[home[writer]].add(home[rule])
    # Each component is as late as the earliest of its rules asks; the place in the list keeps runs alike.
    rank = [(min(rules[rule].order for rule in component), min(component)) for component in components]
    ready = [(rank[number], number) for number, absent in enumerate(missing) if not absent]
    heapq.heapify(ready)
    while ready:
        _, number = heapq.heappop(ready)
        yield components[number]
        for reader in readers[number]:
            missing[reader].discard(number)
            if not missing[reader]:
                heapq.heappush(ready, (rank[reader], reader))


def _negations(rules: Sequence[Rule], needs: list[dict[int, Read]], component: list[int]) -> Iterator[Failure]:
    members = set(component)
    reported: set[object] = set()
    for rule in sorted(component):
        for writer, read in needs[rule].items():
            if not read.negated or writer not in members or (rules[rule].name, read.atom) in reported:
                continue
            cycle = _path(needs, writer, rule, members)
            # What a pattern denies may come about in many ways, and the parts of a rule are one rule to people.
            names = frozenset(rules[each].name for each in cycle)
            if names not in reported:
                error = RuleError(
                    "KG202",
                    _cycle_in_words(rules, needs, [rule, *cycle]),
                    place=read.atom.place or rules[rule].place,
                    hint="Let the negated or counted pattern read something that this rule does not feed.",
                )
                yield Failure(error, rules[rule], tuple(rules[each] for each in cycle))
            reported |= {names, (rules[rule].name, read.atom)}


def _path(needs: list[dict[int, Read]], start: int, goal: int, members: set[int]) -> list[int]:
    """Return a shortest chain of rules from `start` to `goal`, each reading what the next derives."""
    came: dict[int, int] = {start: start}
    queue = [start]
    for node in queue:
        for need in needs[node]:
            if need in members and need not in came:
                came[need] = node
                queue.append(need)
    chain = [goal]
    while chain[-1] != start:
        chain.append(came[chain[-1]])
    return chain[::-1]


def _shown(term: object) -> str:
    """Return a term of an atom as in the text of its rule, where blank nodes and copies of variables have no names."""
    if not isinstance(term, Variable):
        return shorten(term.value) if isinstance(term, NamedNode) else str(term)
    return "[]" if term.name.startswith(".") else str(Variable(term.name.partition("·")[0]))


def _cycle_in_words(rules: Sequence[Rule], needs: list[dict[int, Read]], cycle: Sequence[int]) -> str:
    steps = []
    for reader, writer in pairwise(cycle):
        read = needs[reader][writer]
        how = "negates or counts" if read.negated else "reads"
        where = f" ({read.atom.place})" if read.atom.place else ""
        atom = " ".join(map(_shown, read.atom.positions))
        steps.append(f"{rules[reader]} {how} {atom}{where}, which {rules[writer]} derives")
    return "the rules cannot be stratified: " + "; ".join(steps)


def _mintings(rules: Sequence[Rule], needs: list[dict[int, Read]], component: list[int]) -> Iterator[Failure]:
    for number in sorted(component):
        rule = rules[number]
        if not mints(rule):
            continue
        hint = _LIMITED
        if any(isinstance(head.predicate, Variable) for other in component for head in rules[other].head):
            hint += f" {_ANY_PROPERTY}"
        through = _round(rules, needs, number, component)
        message = f"{rule} makes new terms from what it derives itself (through {through}), which may never end"
        error = RuleError("KG204", message, place=rule.place, hint=hint)
        yield Failure(error, rule, tuple(rules[each] for each in component))


def _round(rules: Sequence[Rule], needs: list[dict[int, Read]], start: int, component: Sequence[int]) -> str:
    """Return the rules of a shortest way from a rule back to itself, the first few by name."""
    members = set(component)
    ways = [_path(needs, need, start, members) for need in needs[start] if need in members]
    names = [str(rules[rule]) for rule in min(ways, key=len)]
    return some(names, _FEW)
