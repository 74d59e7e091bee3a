"""`kg why` and `kg why-not`: what a fact rests on, and what one that is not there lacks."""

from pathlib import Path
from socket import gethostname
from typing import TYPE_CHECKING, Annotated, Final
from urllib.parse import quote

import typer

from kg.cli.commands.query import pairs, resolve_query
from kg.cli.diagnostics import note, report
from kg.cli.options import Json, argument, option, require_one_of, whole, with_settings
from kg.cli.output import folded, json_lines, show, write
from kg.errors import Exit, RuleError, UsageError
from kg.facts import Location
from kg.lazily import lazily
from kg.render.text import count, printable
from kg.settings import Settings
from kg.store.opening import existing, reading_with_cache

if TYPE_CHECKING:
    from collections.abc import Iterable

    from kg.rules.explain.proof import Proof
    from kg.rules.explain.view import View
    from kg.rules.form import Rule
    from kg.store.snapshot import EmbeddedSnapshot


with lazily():
    from rich.text import Text

    from kg.cli.links import Links
    from kg.graph.iris import Iris
    from kg.query.core import row as row_of
    from kg.query.naming import facts
    from kg.rules.explain.text import Line, mermaid, picture, proof_lines, proof_object, why_not_lines, why_not_object
    from kg.rules.explain.why import why_all, why_row
    from kg.views.evidence import Places, places
    from kg.views.why import absent, explaining
    from kg.views.wording import quoted


_FORMATS = ("text", "json", "mermaid", "svg")
_FACT = "For example `kg why patrol subscribes scan_filtered`; quote names that have blanks in them."

Words = Annotated[
    list[str] | None,
    argument("SUBJECT PREDICATE OBJECT", "Names in the store, prefixed names or <iri>s; the object may be a literal."),
]
All = Annotated[bool, option("--all -a", "Show all derivations of the fact.")]
Shortest = Annotated[bool, option("--shortest", "Show the proof with the fewest steps.")]
Form = Annotated[str, option("--format -f FORMAT", f"One of {', '.join(_FORMATS)}.", show_default=True)]


Query = Annotated[str | None, option("--query -q QUERY", "Explain a row of this query: SPARQL, or a stored one.")]
Row = Annotated[str, option("--row N", "Number of the row to explain.", show_default=True)]
Parameter = Annotated[
    list[str] | None,
    option("--param NAME=VALUE", "Set a variable to a text, or with NAME:=TERM to a term of the query."),
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
    depth: Annotated[str, option("--depth N", "How far missing premises are followed.", show_default=True)] = "3",
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
        # The same node in several launch files has proofs that read the same.
        trees: dict[tuple[object, ...], list[Line]] = {}
        for proof in proofs:
            lines = list(proof_lines(proof, view))
            trees.setdefault(tuple((line.branches, line.text, line.where) for line in lines), lines)
        for lines in trees.values():
            print_tree(lines, places(snapshot), Iris(base))


_STYLES: Final = {
    "rule": "cyan",
    "bindings": "dim",
    "condition": "",
    "failure": "red",
    "hint": "yellow",
    "fact": "bold",
}
_LONG: Final = 30
"""Rows of a tree from which on its lines of code are listed below it."""
_BRANCHES: Final = {"├─ ": "│  ", "└─ ": "   "}


def print_tree(lines: "Iterable[Line]", where: "Places", iris: "Iris | None" = None) -> None:
    """Write the lines of a proof; `where` finds sources and their lines.

    With `iris`, those of the store, each line of code is shown below the first fact read from it; below a tree that is
    long, all of them follow once more.
    """
    links = Links(where)
    read: set[tuple[str, str, int | None]] = set()
    cited: list[tuple[Text, str]] = []
    rules: set[str] = set()
    shown = 0
    for line in lines:
        rows = _folded(line, links)
        show(*rows)
        shown += len(rows)
        if line.kind == "rule":
            rules.add(line.text)
        place = (line.evidence.repository or "", line.evidence.path, line.evidence.line) if line.evidence else None
        if iris is None or place is None or place in read:
            continue
        read.add(place)
        if code := _code(line, where, iris):
            show(_dim(f"{_below(line)}  {code}"))
            cited.append((_place(line, links) or Text(), code))
    if shown > _LONG and cited:
        show(Text(f"\n{count(len(rules), 'rule')}, from {count(len(cited), 'line')} of code:"))
        for at, code in cited:
            show(Text("  ").append_text(at), _dim(f"    {code}"))


def _code(line: "Line", where: "Places", iris: "Iris") -> str | None:
    """Return the line of code behind a fact."""
    thing = iris.parse((line.evidence.thing or "").partition("#")[0]) if line.evidence else None
    if line.evidence is None or line.evidence.line is None or thing is None:
        return None
    place = Location(line.evidence.path, line.evidence.line, line.evidence.repository)
    code = quoted(where.code(thing.parts[0], place))
    return printable(code) if code else None


def _dim(line: str) -> "Text":
    """Return a row that is cut where the terminal ends."""
    return Text(line, style="dim", no_wrap=True, overflow="ellipsis")


def _folded(line: "Line", links: "Links") -> "list[Text]":
    """Return the rows of a line, folded inside its branch; places are never broken."""
    words, place = Text(line.text, style=_STYLES[line.kind]), _place(line, links)
    return folded(words, place, Text(line.branches, "dim"), Text(f"{_below(line)}  ", "dim"))


def _place(line: "Line", links: "Links") -> "Text | None":
    """Return where the evidence of a line is, or else its rule, with a link."""
    place = line.evidence or line.place
    if place is None:
        return None
    path = Path(place.path)
    if line.evidence and not path.is_absolute():
        address = links.find(place.path, place.line or 1)
    else:
        address = f"file://{gethostname()}{quote(str(path.absolute()))}"
    return Text(line.where, style=f"green link {address}" if address else "green")


def _below(line: "Line") -> str:
    """Return the branches of the rows below a line."""
    return line.branches[:-3] + _BRANCHES.get(line.branches[-3:], line.branches[-3:])
