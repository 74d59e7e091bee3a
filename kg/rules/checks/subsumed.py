"""KG216: a rule that another one makes superfluous (theta-subsumption: Plotkin 1970)."""

from __future__ import annotations

from itertools import islice
from typing import TYPE_CHECKING, Final

from kg.rules.checks.finding import Context, Finding, at_rule
from kg.rules.form import Assignment, Atom, Element, Exists, Filter, Pattern, Rule, TripleTerm, Variable

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from kg.rules.files import RuleFile

STEPS: Final = 20_000
"""How many comparisons of two parts a pair of rules may take; those that people write take less than a hundred."""


def subsumed(file: RuleFile, context: Context) -> Iterator[Finding]:
    """Yield one finding for a file whose every rule is subsumed by a rule of another file, or by what it reads."""
    if file.rules and all(_is_tautology(rule) for rule in file.rules):
        message = "the rule derives only what it reads"
        yield Finding("KG216", "warning", file.name, message, at_rule(file), "Change its head, or remove it.")
        return
    others = [rule for rule in context.rules.rules if rule.name != file.name]
    wider = [next((other for other in others if subsumes(other, rule)), None) for rule in file.rules]
    covering = [other for other in wider if other is not None]
    if not file.rules or len(covering) < len(file.rules):
        return
    by = covering[0]
    same = any(subsumes(rule, by) for rule in file.rules)
    if same and by.name > file.name:
        return
    words = "has the same meaning as" if same else "derives nothing that is not derived by"
    hint = "Remove one of the two."
    yield Finding("KG216", "warning", file.name, f"the rule {words} {by.name} ({by.place})", at_rule(file), hint)


def _is_tautology(rule: Rule) -> bool:
    """Return whether each triple of the head is in the body."""
    read = [atom.positions for atom in rule.body if isinstance(atom, Atom)]
    return all(atom.positions in read for atom in rule.head)


def subsumes(general: Rule, special: Rule) -> bool:
    """Return whether a renaming of `general`'s variables gives the head of `special` and a part of its body.

    Then whatever `special` derives `general` derives too. Bodies with blocks that are compared by nothing but their
    text (aggregates, blocks of SPARQL) count as equal only when they are the same. The question is NP-complete: where
    `STEPS` comparisons find no renaming, the answer is no.
    """
    steps = iter(range(STEPS))
    renamings = _heads(list(special.head), general.head, {})
    return any(_covers(list(general.body), special.body, bindings, steps) for bindings in islice(renamings, STEPS))


def _heads(
    wanted: Sequence[Atom], offered: Sequence[Atom], bindings: dict[Variable, Pattern]
) -> Iterator[dict[Variable, Pattern]]:
    """Yield the substitutions under which each wanted atom is one of those offered."""
    if not wanted:
        yield bindings
        return
    for atom in offered:
        extended = _matched(atom, wanted[0], bindings)
        if extended is not None:
            yield from _heads(wanted[1:], offered, extended)


def _covers(
    general: list[Element], special: Sequence[Element], bindings: dict[Variable, Pattern], steps: Iterator[int]
) -> bool:
    """Return whether each part of the general body is a part of the special one under some substitution."""
    if not general:
        return True
    first, *rest = general
    # Equivalent rules mostly have the same order: the part in the same place is tried first.
    turned = [*special[1:], *special[:1]]
    for element, _ in zip(special, steps, strict=False):
        extended = _same(first, element, bindings, steps)
        if extended is not None and _covers(rest, turned, extended, steps):
            return True
    return False


def _same(
    general: Element, special: Element, bindings: dict[Variable, Pattern], steps: Iterator[int]
) -> dict[Variable, Pattern] | None:
    if isinstance(general, Atom) and isinstance(special, Atom):
        return _matched(general, special, bindings) if special.asserted or not general.asserted else None
    if isinstance(general, Filter) and isinstance(special, Filter):
        return bindings if _renamed(general.expression.text, bindings) == special.expression.text else None
    if isinstance(general, Assignment) and isinstance(special, Assignment):
        if _renamed(general.expression.text, bindings) != special.expression.text:
            return None
        return _pattern(general.variable, special.variable, bindings)
    if isinstance(general, Exists) and isinstance(special, Exists) and general.negated == special.negated:
        # Blocks are compared as sets both ways: a narrower negated block would let more through, not less.
        if len(general.body) == len(special.body) and _covers(list(general.body), special.body, bindings, steps):
            return bindings
        return None
    return bindings if general == special else None


def _renamed(text: str, bindings: dict[Variable, Pattern]) -> str:
    words = text.split("?")
    named = {variable.name: str(term).removeprefix("?") for variable, term in bindings.items()}
    renamed = [words[0]]
    for word in words[1:]:
        length = next((index for index, sign in enumerate(word) if not (sign.isalnum() or sign == "_")), len(word))
        renamed.append(named.get(word[:length], word[:length]) + word[length:])
    return "?".join(renamed)


def _matched(general: Atom, special: Atom, bindings: dict[Variable, Pattern]) -> dict[Variable, Pattern] | None:
    result: dict[Variable, Pattern] | None = bindings
    for one, other in zip(general.positions, special.positions, strict=True):
        result = None if result is None else _pattern(one, other, result)
    return result


def _pattern(general: Pattern, special: Pattern, bindings: dict[Variable, Pattern]) -> dict[Variable, Pattern] | None:
    if isinstance(general, Variable):
        bound = bindings.get(general)
        if bound is None:
            return {**bindings, general: special}
        return bindings if bound == special else None
    if isinstance(general, TripleTerm) and isinstance(special, TripleTerm):
        result: dict[Variable, Pattern] | None = bindings
        for name in ("subject", "predicate", "object"):
            result = None if result is None else _pattern(getattr(general, name), getattr(special, name), result)
        return result
    return bindings if general == special else None
