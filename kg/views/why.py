"""Why a fact holds, down to the line of code, and why one does not: the views `why`, `why_not` and `why_row`."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Final

from kg.errors import RuleError
from kg.pipeline.reasoning import explained_vocabulary, rules_in_force
from kg.query.naming import facts
from kg.rules.explain.derivations import derivations
from kg.rules.explain.view import View
from kg.rules.explain.why import why as proven
from kg.rules.explain.why import why_all
from kg.rules.explain.why import why_row as traced
from kg.rules.explain.why_not import why_not as lacking
from kg.syntax.names import PREFIXES
from kg.views.arguments import texts, whole
from kg.views.evidence import places
from kg.views.terms import given_term
from kg.views.why_tree import Telling

if TYPE_CHECKING:
    from collections.abc import Mapping
    from pathlib import Path

    from pyoxigraph import Triple

    from kg.rules.files import RuleSet
    from kg.settings import Settings
    from kg.store.snapshot import EmbeddedSnapshot

_MOST_WAYS: Final = 25  # so many ways in which a fact comes about are counted
_MOST_PROOFS: Final = 10


def why(  # noqa: PLR0913 - a fact, and the extent of the answer
    snapshot: EmbeddedSnapshot,
    settings: Settings,
    *,
    subject: str,
    predicate: str,
    object: str,  # noqa: A002 - what the third part of a triple is called
    every: str = "",
) -> dict[str, Any]:
    """Return the proof of a fact; its parts are IRIs, prefixed names, literals as Turtle writes them, or names.

    The keys: `proofs`, of each fact that is meant the one of fewest rules in a row, with `every` (any text) up to ten
    ways in which it comes about; `ways`, how many there are of the first fact, at most 25, then `more_ways` is true.

    A proof is a tree. Each fact has `subject`, `predicate`, `object` (each `{"term", "label"}`, the term as SPARQL
    writes it), `text`, `inferred`, and when it is asserted `graphs`, `evidence`, `line_text` and `line_stored` (the
    line of code: `kg.views.evidence.Places.code`), or else `rule` (`name`, `title`, `documentation`: a list of heading
    and text, `evidence`: its file and line), `bindings` (`name`, `label`, `term`), `premises` (facts), and `conditions`
    (`text`, and `count` and `facts` of what was counted, each with `inferred` and `evidence`). A fact that is proven
    above has `again`, one below the deepest level that is told `cut`, and neither has premises.

    Raises:
        UnknownNameError: KG001 for a word that names nothing.
        UsageError: KG003 for words that name several things.
        RuleError: KG226 when the store does not hold the fact.
    """
    rules, view = explaining(snapshot, settings)
    matches, asserted = facts(snapshot, subject, predicate, object, prefixes=view.prefixes)
    if not asserted:
        raise absent(matches[0], view)
    proofs = [proven(view, rules.rules, fact) for fact in matches[:_MOST_PROOFS]]
    if every:
        proofs = [proof for fact in matches[:_MOST_PROOFS] for proof in why_all(view, rules.rules, fact)][:_MOST_PROOFS]
    ways = 1 if view.asserted(matches[0]) else len(derivations(view, rules.rules, matches[0], _MOST_WAYS))
    telling = Telling(view, rules, places(snapshot), settings.base)
    return {
        "proofs": [telling.proof(proof) for proof in proofs],
        "ways": max(min(ways, _MOST_WAYS), 1),
        "more_ways": ways > _MOST_WAYS,
    }


def why_not(  # noqa: PLR0913 - a fact, and how far it is followed
    snapshot: EmbeddedSnapshot,
    settings: Settings,
    *,
    subject: str,
    predicate: str,
    object: str,  # noqa: A002 - as in `why`
    depth: str = "3",
) -> dict[str, Any]:
    """Return why a fact does not hold: `fact`, `held`, `attempts`, and `nearest`, what the store has instead, in words.

    If the store holds it, `held` is true, without attempts. An attempt is a rule that could derive
    it: `rule` (as in `why`), `held` (facts that match, each with `inferred` and `evidence`), `fails` (what does not,
    None where all holds and rules were not run since), `nearest`, and `deeper`, the same object about a premise that is
    missing.

    Raises as `why`, but for KG226.
    """
    rules, view = explaining(snapshot, settings)
    matches, asserted = facts(snapshot, subject, predicate, object, prefixes=view.prefixes)
    telling = Telling(view, rules, places(snapshot), settings.base)
    if asserted:
        return {"fact": telling.triple(matches[0]), "held": True, "attempts": [], "nearest": []}
    steps = min(max(whole(depth, 3), 1), 20)
    return {**telling.lacking(lacking(view, rules.rules, matches[0], depth=steps)), "held": False}


def explaining(
    snapshot: EmbeddedSnapshot,
    settings: Settings,
    broken: list[RuleError] | None = None,
    *,
    cache: Path | None = None,
) -> tuple[RuleSet, View]:
    """Return the rules in force, and the store as explanations with these rules see it.

    With the folder `cache` of the store, the rules are without their texts and documentation, and kept there.

    Files that cannot be used are left out, since why a fact holds does not wait until another rule is mended; their
    errors are added to `broken`.
    """
    rules = rules_in_force(settings, [] if broken is None else broken, cache=cache)
    prefixes = {name: iri for file in rules.files for name, iri in file.prefixes.items()} | PREFIXES
    return rules, View(snapshot, explained_vocabulary(settings), rules.rules, prefixes=prefixes)


def absent(fact: Triple, view: View) -> RuleError:
    """Return the error about a fact that the store does not hold, KG226."""
    words = " ".join(f"'{view.spelt(term)}'" for term in (fact.subject, fact.predicate, fact.object))
    message = f"the store does not contain {view.sentence(fact)}"
    return RuleError("KG226", message, hint=f"`kg why-not {words}` shows what is missing.")


def why_row(
    snapshot: EmbeddedSnapshot, settings: Settings, *, query: str, row: str | Mapping[str, str]
) -> dict[str, Any]:
    """Return the proofs of the facts that a SELECT `query` matched for a `row`: name of variable to term, as N-Triples.

    The row may also be given as JSON. The keys: `row` (`name`, and `term`, `label`, `short` of its value), `proofs` as
    of the view `why`, `conditions`, sentences of what else held, and `remark`, which says where the row was made of
    several solutions, as those of groups are, that the facts are those of one; else it is null.

    Raises:
        UsageError: KG003 for what is not a row, or a term that is none.
        QueryError: KG502 or KG516 for a query that is refused.
        RuleError: KG201 for a query that is not a SELECT, KG226 for a row that cannot be traced back (of inner groups).
    """
    rules, view = explaining(snapshot, settings)
    terms = {name: given_term(text) for name, text in texts(row, "row").items()}
    derivation = traced(view, rules.rules, query, terms)
    telling = Telling(view, rules, places(snapshot), settings.base)
    return {
        "row": telling.bindings(terms),
        "proofs": [telling.proof(one) for one in derivation.proofs],
        "conditions": [one.text for one in derivation.conditions],
        "remark": derivation.remark,
    }
