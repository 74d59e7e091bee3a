"""`kg why` and `kg why-not`: what a fact rests on, and what one that is not there lacks."""

from typing import TYPE_CHECKING, Annotated

import typer

from kg.cli.diagnostics import note, report
from kg.cli.numbers import whole
from kg.cli.options import Json, require_one_of, with_settings
from kg.cli.output import json_lines, write
from kg.cli.query_text import pairs, resolve_query
from kg.errors import Exit, RuleError, UsageError
from kg.lazily import lazily
from kg.settings import Settings
from kg.store.opening import existing, reading_with_cache

if TYPE_CHECKING:
    from collections.abc import Iterable
    from pathlib import Path

    from kg.rules.explain.proof import Proof
    from kg.rules.explain.view import View
    from kg.rules.form import Rule
    from kg.store.snapshot import EmbeddedSnapshot

with lazily():
    from kg.cli.trees import print_tree
    from kg.graph.iris import Iris
    from kg.query.core import row as row_of
    from kg.query.naming import facts
    from kg.rules.explain.export import mermaid, proof_object, why_not_object
    from kg.rules.explain.picture import picture
    from kg.rules.explain.rows import why_row
    from kg.rules.explain.text import proof_lines, why_not_lines
    from kg.rules.explain.why import why_all
    from kg.views.evidence import places
    from kg.views.why import absent, explaining

_FORMATS = ("text", "json", "mermaid", "svg")
_FACT = "For example `kg why patrol subscribes scan_filtered`; quote names that have blanks in them."

Words = Annotated[
    list[str] | None,
    typer.Argument(
        metavar="SUBJECT PREDICATE OBJECT",
        help="Names in the store, prefixed names or <iri>s; the object may be a literal.",
    ),
]
All = Annotated[bool, typer.Option("--all", "-a", help="Show all derivations of the fact.")]
Shortest = Annotated[bool, typer.Option("--shortest", help="Show the proof with the fewest steps.")]
Form = Annotated[
    str, typer.Option("--format", "-f", metavar="FORMAT", help=f"One of {', '.join(_FORMATS)}.", show_default=True)
]


Query = Annotated[
    str | None,
    typer.Option("--query", "-q", metavar="QUERY", help="Explain a row of this query: SPARQL, or a stored one."),
]
Row = Annotated[str, typer.Option("--row", metavar="N", help="Number of the row to explain.", show_default=True)]
Parameter = Annotated[
    list[str] | None,
    typer.Option(
        "--param", metavar="NAME=VALUE", help="Set a variable to a text, or with NAME:=TERM to a term of the query."
    ),
]


@with_settings("rules", "rule_families", "store")
def why(  # noqa: PLR0913 - the options of a command
    words: Words = None,
    *,
    settings: Settings,
    query: Query = None,
    row: Row = "1",
    param: Parameter = None,
    every: All = False,
    shortest: Shortest = False,
    form: Form = "text",
    json: Json = False,
) -> None:
    """Prove a fact: show the rules that derive it, down to the source line.

    Use the names that `kg nodes` and `kg topics` list. If a name is ambiguous, kg picks the things for which the store
    contains the fact. For example:

        kg why talker publishes /chatter
        kg why talker rnkg:hasCapability SpeechOutput --all
        kg why talker publishes chatter --format mermaid
        kg why --query who-publishes --param topic=/chatter --row 2
    """
    form = "json" if json else form
    require_one_of(form, _FORMATS, "format")
    with reading_with_cache(settings) as (snapshot, cache):
        rules, view = _rules_and_view(snapshot, settings, cache)
        if query is not None:
            if words:
                raise UsageError("KG003", "a fact and --query are mutually exclusive", hint="See `kg why --help`.")

            resolved, number = resolve_query(query, None, settings), whole(row, "--row", 1)
            text, matched = row_of(snapshot, resolved, pairs(param or []), number, timeout=settings.timeout or None)
            note(f"row {number}: " + ", ".join(f"?{name} = {view.label(term)}" for name, term in matched.items()))
            derivation = why_row(view, rules, text, matched)
            if derivation.remark:
                note(derivation.remark)
            for condition in derivation.conditions:
                note(f"where {condition.text}")
            proofs: Iterable[Proof] = derivation.proofs
        else:
            proofs = _proofs(_three(words), snapshot, view, rules, every=every, shortest=shortest)
        _show(list(proofs), view, form, snapshot, settings.base)


def _three(words: list[str] | None) -> tuple[str, str, str]:
    if len(words or []) != 3:  # noqa: PLR2004 - a fact has three parts
        raise UsageError("KG003", "a fact is SUBJECT PREDICATE OBJECT", hint=_FACT)
    subject, predicate, value = words or []
    return subject, predicate, value


def _proofs(  # noqa: PLR0913 - the choices of the user
    words: tuple[str, str, str],
    snapshot: "EmbeddedSnapshot",
    view: "View",
    rules: "tuple[Rule, ...]",
    *,
    every: bool,
    shortest: bool,
) -> "Iterable[Proof]":
    from kg.rules.explain.why import why as explained  # noqa: PLC0415 - start-up time

    matches, asserted = facts(snapshot, *words, prefixes=view.prefixes)
    if not asserted:
        raise absent(matches[0], view)
    for fact in matches:
        if every:
            yield from why_all(view, rules, fact)
        else:
            yield explained(view, rules, fact, shortest=shortest)


@with_settings("rules", "rule_families", "store")
def why_not(
    words: Words = None,
    *,
    settings: Settings,
    depth: Annotated[
        str, typer.Option("--depth", metavar="N", help="How far missing premises are followed.", show_default=True)
    ] = "3",
    json: Json = False,
) -> None:
    """Show why a fact is missing: what each rule that could derive it lacks.

    For each rule, shows the parts that match, the first part that does not, and the nearest existing match. For
    example:

        kg why-not listener rnkg:feeds talker
    """
    from kg.rules.explain.why_not import why_not as explained  # noqa: PLC0415 - start-up time

    opened = existing(settings)
    with opened.read() as snapshot:
        rules, view = _rules_and_view(snapshot, settings, opened.layout.cache)
        matches, asserted = facts(snapshot, *_three(words), prefixes=view.prefixes)
        if asserted:
            note(f"{view.sentence(matches[0])}: the store holds it; `kg why` explains it")
            raise typer.Exit(Exit.FOUND)
        answer = explained(view, rules, matches[0], depth=whole(depth, "--depth", 1, 20))
        if json:
            json_lines([why_not_object(answer, view)])
        else:
            print_tree(why_not_lines(answer, view), places(snapshot), Iris(settings.base))


def _rules_and_view(snapshot: "EmbeddedSnapshot", settings: Settings, cache: "Path") -> "tuple[tuple[Rule, ...], View]":
    """Return the rules in force, and the store as explanations with these rules see it; rules left out are named."""
    broken: list[RuleError] = []
    rules, view = explaining(snapshot, settings, broken, cache=cache)
    for error in broken:
        report(error, "warning")
    return rules.rules, view


def _show(proofs: "list[Proof]", view: "View", form: str, snapshot: "EmbeddedSnapshot", base: str) -> None:
    if form == "json":
        json_lines(proof_object(proof, view) for proof in proofs)
    elif form == "mermaid":
        write(mermaid(proofs, view).rstrip())
    elif form == "svg":
        write(picture(proofs, view).rstrip())
    else:
        for proof in proofs:
            print_tree(proof_lines(proof, view), places(snapshot), Iris(base))
