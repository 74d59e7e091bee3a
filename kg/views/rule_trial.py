"""Trial of one rule on a snapshot: its inferences, each with one derivation; nothing is written."""

from __future__ import annotations

import time
from dataclasses import dataclass
from typing import TYPE_CHECKING, Final, NamedTuple, TypeAlias

from pyoxigraph import BlankNode, Triple

from kg.errors import RuleError
from kg.rules.authoring.examples import parse_examples
from kg.rules.authoring.library import Library
from kg.rules.authoring.spelling import spell_triple
from kg.rules.authoring.testing import run_example
from kg.rules.dependencies import depends, reads
from kg.rules.engine.heads import new_node
from kg.rules.explain.derivations import bound_by, derivation_of, instance
from kg.rules.form import Exists, Rule, Term, bound_in, is_auxiliary, mentions
from kg.syntax.names import PREFIXES

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping, Sequence

    from kg.rules.explain.proof import Derivation
    from kg.rules.explain.view import View
    from kg.rules.files import RuleFile

Solution: TypeAlias = "dict[str, Term]"

_SECONDS: Final = 5.0  # how long matches are looked for
_PAGES: Final = 5  # so many facts are tried as an example
_PAGE: Final = """# {title}

## As the store has it

```turtle given
{given}
```

```turtle expect
{expected}
```
"""


@dataclass(frozen=True, slots=True)
class Inferred:
    """A fact that a rule infers, and how; `known` is whether the store has it already."""

    fact: Triple
    derivation: Derivation
    known: bool


@dataclass(frozen=True, slots=True)
class Tried:
    """Inferences of a rule: `facts` are those returned, new ones first; of `looked` that were found, `fresh` are new.

    `whole` tells that there are no others, `recursive` that the rule reads what it infers, so that running it gives
    more.
    """

    facts: tuple[Inferred, ...]
    looked: int
    fresh: int
    whole: bool
    recursive: bool


class _Match(NamedTuple):
    """How a fact was found first, and whether the store has it."""

    rule: Rule
    solution: Solution
    known: bool


def trial(view: View, file: RuleFile, most: int) -> Tried:
    """Apply the rules of a file once to all that the store has, inferences among it; at most `most` facts are returned.

    The store's engine looks for the matches for some seconds: reading what a rule needs takes longer on large stores.
    """
    rules = [rule for rule in file.rules if not any(is_auxiliary(head.predicate) for head in rule.head)]
    facts: dict[Triple, _Match] = {}
    end = time.monotonic() + _SECONDS
    whole = True
    for number, rule in enumerate(rules):
        now = time.monotonic()
        until = now + (end - now) / (len(rules) - number)
        whole = _search(view, rule, facts, until) and whole
    inferred: list[Inferred] = []
    for fact, match in sorted(facts.items(), key=lambda item: item[1].known):
        if len(inferred) == most:
            break
        derivation = derivation_of(view, match.rule, match.solution)
        if derivation is not None:
            inferred.append(Inferred(fact, derivation, match.known))
    fresh = sum(not match.known for match in facts.values())
    heads = [head for rule in file.rules for head in rule.head]
    recursive = any(depends(one.atom, head) for rule in file.rules for one in reads(rule) for head in heads)
    return Tried(tuple(inferred), len(facts), fresh, whole, recursive)


def _search(view: View, rule: Rule, facts: dict[Triple, _Match], until: float) -> bool:
    """Add the inferences of a rule to `facts` until a deadline; return whether these are all.

    Each EXISTS is asked for by itself. Inside of a query the engine does not see there what is bound around it, and
    looks through all that it may match.
    """
    inner = [(index, element) for index, element in enumerate(rule.body) if isinstance(element, Exists)]
    conditions = [(one, [each.name for each in bound_in(rule.body[:index]) & mentions(one)]) for index, one in inner]
    outer = [element for element in rule.body if not isinstance(element, Exists)]
    for solution in view.stream(outer, bound_by(outer), {}):
        if time.monotonic() > until:
            return False
        seen = ((one, {name: solution[name] for name in names if name in solution}) for one, names in conditions)
        if all(bool(view.solutions(one.body, list(bound), bound, 1)) != one.negated for one, bound in seen):
            for fact in _facts(rule, solution):
                if fact not in facts:
                    facts[fact] = _Match(rule, solution, bool(view.graphs(fact)))
    return True


def _facts(rule: Rule, solution: Solution) -> Iterator[Triple]:
    """Yield the facts of a solution, with the blank nodes that the engine of rules would make."""
    labels = {node for head in rule.head for node in head.positions if isinstance(node, BlankNode)}
    names = bound_by(rule.body) if labels else []
    blanks = {str(node): new_node(rule, node.value, names, solution) for node in labels}
    for head in rule.head:
        fact = instance(head, {**solution, **blanks})
        if fact is not None:
            yield fact


def examples(file: RuleFile, facts: Sequence[Inferred]) -> str:
    """Return a page of examples for `kg rules test`, made of the first fact found whose premises alone give it.

    Empty where there is none: where the rule counts, for instance, what it counts is not a premise.
    """
    for one in facts[:_PAGES]:
        page = _page(file, one.derivation)
        try:
            results = [run_example(file, example, Library(())) for example in parse_examples(page, "examples")]
        except RuleError:
            continue
        if all(result.passed for result in results):
            return page
    return ""


def _page(file: RuleFile, derivation: Derivation) -> str:
    prefixes = file.all_prefixes
    heads = [fact for head in derivation.rule.head if (fact := instance(head, derivation.bindings))]
    given = _statements(derivation.facts, prefixes)
    expected = _statements(heads, prefixes)
    title = file.documentation.title or file.name
    return _PAGE.format(title=title, given=given, expected=expected)


def _statements(facts: Sequence[Triple], prefixes: Mapping[str, str]) -> str:
    lines = [f"{spell_triple(fact, prefixes)} ." for fact in facts]
    used = {name for name in prefixes if name not in PREFIXES and any(f"{name}:" in line for line in lines)}
    return "\n".join([*(f"@prefix {name}: <{prefixes[name]}> ." for name in sorted(used)), *lines])
