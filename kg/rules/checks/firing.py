"""Checks of whether a rule can fire: on the store (KG213, KG205), and without any data (KG214)."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import pyoxigraph

from kg.query.runner import DeadlineError, in_thread
from kg.rules.checks.finding import Context, Finding, at_rule
from kg.rules.dependencies import depends
from kg.rules.explain.derivations import bound_by
from kg.rules.explain.view import View, Vocabulary
from kg.rules.form import Assignment, Atom, Element, Exists, Filter, Rule, atoms_of, is_auxiliary, place_of
from kg.rules.sparql import brief
from kg.store.snapshot import MemorySnapshot

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from kg.rules.files import RuleFile


@dataclass(frozen=True, slots=True)
class StoreOf:
    """A snapshot, after rules have run over it."""

    view: View

    def matches(self, body: tuple[Element, ...]) -> bool:
        """Return whether a body has a solution."""
        return bool(self.view.solutions(body, bound_by(body), {}, 1))

    def failing(self, body: tuple[Element, ...]) -> Element | None:
        """Return the first part of a body that leaves it without solutions."""
        return next((part for index, part in enumerate(body) if not self.matches(body[: index + 1])), None)


def nothing(vocabulary: Vocabulary) -> StoreOf:
    """Return a store without data."""
    return StoreOf(View(MemorySnapshot(pyoxigraph.Store()), vocabulary))


def never_fires(file: RuleFile, context: Context) -> Iterator[Finding]:
    """Yield one finding for a file whose rules match nothing, with the first part that matches nothing.

    If the store does not answer in time, the finding reports that.
    """
    store = context.store
    rules = [rule for rule in file.rules if not _auxiliary(rule)]
    if store is None or not rules:
        return
    try:
        fires, element = in_thread(lambda: _any_fires(store, rules), context.seconds)
    except DeadlineError:
        message = f"whether the rule fires is not known: the store did not answer in {context.seconds:g} s"
        hint = "Join the parts of the body by variables or name their predicates, or raise `--timeout`."
        yield Finding("KG205", "note", file.name, message, at_rule(file), hint)
        return
    if not fires:
        reason = f": nothing matches {brief(element, file.all_prefixes)}" if element else ""
        place = (place_of(element) if element else None) or at_rule(file)
        yield Finding(
            "KG213",
            "note",
            file.name,
            f"on this store the rule derives nothing{reason}",
            place,
            _hint(element, file, context),
        )


def _any_fires(store: StoreOf, rules: Sequence[Rule]) -> tuple[bool, Element | None]:
    """Return whether one of the rules has a match, else the part of the first one that leaves it without."""
    if any(store.matches(rule.body) for rule in rules):
        return True, None
    return False, store.failing(rules[0].body)


def _hint(element: Element | None, file: RuleFile, context: Context) -> str:
    """Return a hint for a part that no solution passes."""
    if isinstance(element, Atom):
        heads = ((rule.name, head) for rule in context.cut or context.rules.rules for head in rule.head)
        writer = next((name for name, head in heads if name != file.name and depends(element, head)), None)
        if writer:
            return f"{writer} infers such triples: check whether it fires; `kg rules run` applies it."
        return "Correct the names in it, or build the packages that assert it; `kg why-not` shows more."
    if isinstance(element, Filter | Assignment):
        return "The parts before it match: compare the values they bind with those it requires."
    if isinstance(element, Exists):
        count = "all" if element.negated else "none"
        return f"The parts before it match, but {count} of the matches satisfy the pattern inside it."
    return "The parts before it match, but no match satisfies this part."


def _auxiliary(rule: Rule) -> bool:
    """Return whether a rule reads or derives auxiliary predicates of decomposition, which no store holds."""
    return any(is_auxiliary(atom.predicate) for atom in (*rule.head, *(atom for atom, _ in atoms_of(rule.body))))


def always_fires(file: RuleFile, context: Context) -> Iterator[Finding]:
    """Yield one finding for a file that has a rule that an empty store satisfies."""
    empty = context.empty
    if empty is None:
        return
    try:
        fires = in_thread(lambda: any(empty.matches(rule.body) for rule in file.rules), context.seconds)
    except DeadlineError:
        return  # rows of VALUES alone may be too many to join; their results are unknown
    if fires:
        message = "the rule fires whatever the data are: an empty store satisfies its body"
        hint = "State facts in an ontology or in DATA, or add what the rule should depend on."
        yield Finding("KG214", "warning", file.name, message, at_rule(file), hint)
