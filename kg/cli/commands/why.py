"""`kg why` and `kg why-not`: what a fact rests on, and what one that is not there lacks."""

from typing import TYPE_CHECKING, Annotated, Any

import typer

from kg.cli.diagnostics import note
from kg.cli.options import Json, Rules, Store
from kg.cli.output import json_lines, show, write
from kg.cli.session import session
from kg.errors import Exit, UsageError
from kg.store.opening import reading

if TYPE_CHECKING:
    from collections.abc import Iterable

    from pyoxigraph import Triple

    from kg.rules.explain.proof import Proof
    from kg.rules.explain.text import Line
    from kg.rules.explain.view import View
    from kg.rules.form import Rule
    from kg.settings import Settings
    from kg.store.snapshot import EmbeddedSnapshot

__all__ = ["why", "why_not"]

_FORMATS = ("text", "json", "mermaid", "svg")

Subject = Annotated[str, typer.Argument(metavar="SUBJECT", help="A name in the store, a prefixed name or an <iri>.")]
Predicate = Annotated[str, typer.Argument(metavar="PREDICATE", help="A property, `publishes` or `rnkg:publishes`.")]
Object = Annotated[str, typer.Argument(metavar="OBJECT", help="A name, a prefixed name, an <iri> or a literal.")]
All = Annotated[bool, typer.Option("--all", "-a", help="Every way in which the fact comes about.")]
Shortest = Annotated[bool, typer.Option("--shortest", help="The proof with the fewest steps.")]
Form = Annotated[
    str, typer.Option("--format", "-f", metavar="FORMAT", help=f"One of {', '.join(_FORMATS)}.", show_default=True)
]


def why(  # noqa: PLR0913 - the options of a command
    context: typer.Context,
    subject: Subject,
    predicate: Predicate,
    value: Object,
    *,
    every: All = False,
    shortest: Shortest = False,
    form: Form = "text",
    json: Json = False,
    rules: Rules = None,
    store: Store = None,
) -> None:
    """Show why a fact holds: the rules that derive it, down to the line of code.

    Names are those of `kg nodes` and `kg topics`; where several things have a name, those are meant of which the
    store holds the fact. For example:

        kg why talker publishes /chatter
        kg why talker rnkg:hasCapability SpeechOutput --all
        kg why talker publishes chatter --format mermaid
    """
    from kg.query.naming import facts  # noqa: PLC0415 - start-up time
    from kg.rules.explain.why import why as explained  # noqa: PLC0415 - start-up time
    from kg.rules.explain.why import why_all  # noqa: PLC0415 - start-up time

    form = _form("json" if json else form)
    settings = session(context).settings(store=store, rules=rules)
    with reading(settings) as snapshot:
        view, known = _view(snapshot, settings), _rules(settings)
        found, held = facts(snapshot, subject, predicate, value)
        if not held:
            _absent(found[0], view)
        for fact in found:
            if every:
                proofs: Iterable[Proof] = why_all(view, known, fact)
            else:
                proofs = [explained(view, known, fact, shortest=shortest)]
            for proof in proofs:
                _show(proof, view, form, snapshot)


def why_not(  # noqa: PLR0913 - the options of a command
    context: typer.Context,
    subject: Subject,
    predicate: Predicate,
    value: Object,
    *,
    depth: Annotated[
        int, typer.Option("--depth", metavar="N", min=1, max=20, help="How far missing premises are followed.")
    ] = 3,
    json: Json = False,
    rules: Rules = None,
    store: Store = None,
) -> None:
    """Show why a fact does not hold: what each rule that could derive it lacks.

    For each rule: what holds, the first part that does not, and the nearest thing that is there. For example:

        kg why-not listener rnkg:feeds talker
    """
    from kg.query.naming import facts  # noqa: PLC0415 - start-up time
    from kg.rules.explain.export import why_not_object  # noqa: PLC0415 - start-up time
    from kg.rules.explain.text import why_not_lines  # noqa: PLC0415 - start-up time
    from kg.rules.explain.why_not import why_not as explained  # noqa: PLC0415 - start-up time

    settings = session(context).settings(store=store, rules=rules)
    with reading(settings) as snapshot:
        view, known = _view(snapshot, settings), _rules(settings)
        found, held = facts(snapshot, subject, predicate, value)
        if held:
            note(f"{view.sentence(found[0])}: the store holds it; `kg why` explains it")
            raise typer.Exit(Exit.FOUND)
        answer = explained(view, known, found[0], depth=depth)
        if json:
            json_lines([why_not_object(answer, view)])
        else:
            _print(why_not_lines(answer, view), snapshot)


def _form(name: str) -> str:
    if name not in _FORMATS:
        raise UsageError("KG003", f"`{name}` is no form of a proof", hint=f"One of {', '.join(_FORMATS)}.")
    return name


def _absent(fact: "Triple", view: "View") -> None:
    from kg.errors import RuleError  # noqa: PLC0415 - start-up time

    words = " ".join(f"'{view.spelt(term)}'" for term in (fact.subject, fact.predicate, fact.object))
    message = f"the store does not hold {view.sentence(fact)}"
    raise RuleError("KG226", message, hint=f"`kg why-not {words}` says what is missing.")


def _view(snapshot: "EmbeddedSnapshot", settings: "Settings") -> "View":
    from kg.pipeline.reasoning import explained_vocabulary  # noqa: PLC0415 - start-up time
    from kg.rules.explain.view import View  # noqa: PLC0415 - start-up time

    return View(snapshot, explained_vocabulary(settings.base))


def _rules(settings: "Settings") -> "tuple[Rule, ...]":
    from kg.pipeline.reasoning import rules_in_force  # noqa: PLC0415 - start-up time

    return rules_in_force(settings).rules


def _show(proof: "Proof", view: "View", form: str, snapshot: "EmbeddedSnapshot") -> None:
    from kg.rules.explain.export import mermaid, proof_object  # noqa: PLC0415 - start-up time
    from kg.rules.explain.picture import picture  # noqa: PLC0415 - start-up time
    from kg.rules.explain.text import proof_lines  # noqa: PLC0415 - start-up time

    if form == "json":
        json_lines([proof_object(proof, view)])
    elif form == "mermaid":
        write(mermaid(proof, view).rstrip())
    elif form == "svg":
        write(picture(proof, view).rstrip())
    else:
        _print(proof_lines(proof, view), snapshot)


def _print(lines: "Iterable[Line]", snapshot: "EmbeddedSnapshot") -> None:
    from kg.cli.links import Links  # noqa: PLC0415 - start-up time
    from kg.graph.source_states import sources  # noqa: PLC0415 - start-up time

    links = Links.of(sources(snapshot))
    for line in lines:
        show(_styled(line, links))


def _styled(line: "Line", links: Any) -> Any:
    """Return a line as rich text: branches dim, places as links."""
    from rich.text import Text  # noqa: PLC0415 - start-up time

    styles = {"rule": "cyan", "bindings": "dim", "condition": "", "failure": "red", "hint": "yellow", "fact": "bold"}
    text = Text(line.branches, style="dim")
    text.append(line.text, style=styles[line.kind])
    where = line.evidence or line.place
    if where:
        address = links.find(line.evidence.path, line.evidence.line or 1) if line.evidence else None
        text.append("  ")
        text.append(str(where), style=f"green link {address}" if address else "green")
    return text
