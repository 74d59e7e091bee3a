"""`kg rules new`, `list`, `show`, `lsp`, `compile` and `diff`: begin rules, read them, see what they would change."""

import os
import re
import shlex
import sys
from collections import Counter
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Final

import typer

from kg.cli.completion import rules as rule_names
from kg.cli.diagnostics import note, report, say
from kg.cli.options import Json, RuleName, Store, argument, option, require_one_of, session, takes, with_settings
from kg.cli.output import Column, json_lines, listing, make_table, numbers, show, terminal, write
from kg.errors import Exit, GraphError, Place, RuleError
from kg.lazily import lazily
from kg.render.text import count, printable
from kg.settings import DECLARED, Settings

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Sequence

    from rich.console import RenderableType

    from kg.rules.authoring.profiling import RuleProfile
    from kg.rules.authoring.runs import Share
    from kg.rules.authoring.testing import Result, RuleCoverage
    from kg.rules.explain.view import View
    from kg.rules.files import Documentation
    from kg.rules.form import Term
    from kg.rules.reports import RunReport


with lazily():
    from pyoxigraph import NamedNode
    from rich.padding import Padding
    from rich.table import Table
    from rich.text import Text

    from kg.editors.source import Source
    from kg.pipeline.authoring import attempt
    from kg.pipeline.reasoning import ontology_schema
    from kg.rules import printing
    from kg.rules.authoring.differences import Changed, Difference, difference, difference_objects
    from kg.rules.authoring.library import Entry, Library
    from kg.rules.authoring.manual import Manual, documented, entry_object, manual, manual_object
    from kg.rules.authoring.spelling import spell_term, spell_triple
    from kg.rules.authoring.starting import choose, find_rule, start
    from kg.rules.reading import own_folder


Chosen = Annotated[
    list[str] | None,
    argument("RULE", "Rules, families, files or folders; by default all rules.", autocompletion=rule_names),
]
NewName = Annotated[str, argument("FAMILY/NAME", "Name of the new rule.")]
Notation = Annotated[str, option("--notation NOTATION", "rq (SPARQL), ttl (SHACL) or srl.")]


@takes(DECLARED[one] for one in ("rules", "rule_families"))
def new(context: typer.Context, name: NewName, *, notation: Notation = "rq", **given: str | None) -> None:
    """Create a rule that runs as it is, with examples that pass.

    The files are written to the first folder of the setting `rules`. For example:

        kg rules new wiring/listens-to
        kg rules new wiring/listens-to --notation srl
    """
    for path in start(name, own_folder(session(context).settings(**given)), notation):
        write(here(path))
    option = f" --rules {shlex.quote(given['rules'])}" if given["rules"] else ""
    note("next steps:")
    for command in ("check", "test", "diff"):
        note(f"  kg rules {command} {name}{option}")


@with_settings("rules", "rule_families")
def list_rules(chosen: Chosen = None, *, settings: Settings, json: Json = False) -> None:
    """List the active rules: those of kg, of installed packs, and your own.

    For example:

        kg rules list
        kg rules list capability
    """
    library = Library.of(settings)
    listed = [(entry, *documented(library, entry)) for entry in choose(library, chosen or ())]
    errors = [*library.problems, *(error for _, _, error in listed if error)]
    objects = (entry_object(*each) for each in listed) if json else None
    rows = [list_row(*each) for each in listed]
    listing(list_columns(rows), rows, objects=objects)
    for error in errors:
        report(error)
    if terminal() and not json:
        families = len({entry.family for entry, _, _ in listed})
        note(f"{count(len(listed), 'rule')} of {count(families, 'family', 'families')}; `kg rules show NAME` shows one")
        idle = sorted({entry.family for entry in library.entries.values() if not entry.in_force})
        if idle and not chosen:
            note(f"inactive: {', '.join(idle)}; `kg rules list {idle[0]}` lists them")
    if errors:
        raise typer.Exit(Exit.FOUND)


@with_settings("rules", "rule_families")
def show_rule(name: RuleName, *, settings: Settings, json: Json = False) -> None:
    """Show one rule: documentation, text, inputs, results and dependencies."""
    library = Library.of(settings)
    entry = find_rule(library, name)
    described = manual(library, entry, ontology_schema(settings))
    if json:
        json_lines([manual_object(entry, described)])
    else:
        show(*manual_lines(described))
    if described.problem:
        report(described.problem)
        raise typer.Exit(Exit.FOUND)


@takes(DECLARED[one] for one in ("rules", "rule_families"))
def lsp(context: typer.Context, *, store: Store = None, **given: str | None) -> None:
    """Serve editors: rules as you type them, and the findings of `kg lint`.

    Rules get errors, fixes, completion, documentation, definitions, references and renaming. Launch files and code get
    the findings on the store in force. When a file is saved, its source is built again.

    Speaks the Language Server Protocol on standard input and output; docs/editors.md has configurations for editors.
    Needs the extra `lsp`: pip install 'kg-ros[lsp]'.
    """
    try:
        from kg.editors.server import language_server  # noqa: PLC0415 - start-up time
    except ImportError as error:
        raise GraphError("KG605", f"{error.name} is not installed", hint="pip install 'kg-ros[lsp]'") from error

    # The editor names the folder to work in later.
    store = store if store is None or "://" in store else str(Path(store).absolute())
    options = [f"--{name.replace('_', '-')}={value}" for name, value in given.items() if value]
    source = Source(lambda: session(context).settings(store=store, **given), options)
    # Copies: the server closes its streams when the editor leaves, and the command still has words to say.
    with (
        os.fdopen(os.dup(sys.stdin.fileno()), "rb") as reading,
        os.fdopen(os.dup(sys.stdout.fileno()), "wb") as writing,
    ):
        language_server(source).start_io(reading, writing)


_FORMS: Final = ("form", "rq", "srl", "ttl")

To = Annotated[str, option("--to NOTATION", "form, rq (SPARQL), srl or ttl (SHACL).")]


@with_settings("rules", "rule_families")
def compile_rule(name: RuleName, *, settings: Settings, to: To = "form") -> None:
    """Print a rule as it is evaluated, or in another notation.

    A rule with alternatives (UNION, OPTIONAL, paths) is compiled into several. In another notation they are a file
    that derives the same; in SPARQL one rule, with UNION. For example:

        kg rules compile communication/feeds
        kg rules compile communication/feeds --to srl
    """
    require_one_of(to, _FORMS, "notation")
    library = Library.of(settings)
    entry = find_rule(library, name)
    file = library.read(entry.name)
    prefixes = file.all_prefixes
    if to == "form":
        strata = manual(library, entry, ontology_schema(settings)).strata
        text = printing.to_form(file.rules, prefixes, strata)
        write(text.replace(str(file.path), here(file.path)))
        return
    if not file.rules and not file.data:
        hint = "Its pattern matches no graph, or its head is empty."
        message = "the file derives nothing: there is no rule to print"
        raise RuleError("KG209", message, place=Place(str(file.path)), hint=hint)
    if to == "srl":
        write(printing.to_srl(file.rules, prefixes, file.data))
    else:
        printer = printing.to_rq if to == "rq" else printing.to_turtle
        write(printer((*file.rules, *printing.of_data(file)), prefixes))


@with_settings("rules", "rule_families", "limit", "timeout", "store")
def diff(chosen: Chosen = None, *, settings: Settings, json: Json = False) -> None:
    """Show what the rules on disk would add to and remove from the store.

    Nothing is written. With rules named, shows only the changes caused by them. Exits with 1 if there are changes. For
    example:

        kg rules diff
        kg rules diff wiring/listens-to
    """
    with attempt(settings, chosen or ()) as trial:
        changed = difference(trial.bench, trial.files, trial.chosen, trial.limits)
        if json:
            json_lines(difference_objects(changed))
        else:
            show_difference(changed, trial.view, settings.limit)
    if changed:
        raise typer.Exit(Exit.FOUND)


def show_difference(changed: "Difference", view: "View", most: int) -> None:
    """Show what comes and goes, up to `most` triples (0: all), and how much of it by rule."""
    shown = changed.changes[: most or None]
    if shown:
        show(*change_lines(shown, view))
    if len(shown) < len(changed.changes):
        note(f"{len(changed.changes) - len(shown):,} more not shown; --limit 0 shows all")
    for line in difference_words(changed):
        say(line)


_ITEM: Final = re.compile(r"(?:[-*]|\d+[.)]) ")
COLUMNS: Final = (
    Column("rule", "name"),
    Column("title"),
    Column("notation", "dim"),
    Column("since", "dim", spare=1),
    Column("state", "dim", spare=1),
)


def here(path: str | Path) -> str:
    """Return a path relative to the working folder, if it is below it."""
    text = os.path.relpath(path)
    return str(path) if text.startswith("..") else text


def list_columns(rows: "Iterable[Sequence[str | None]]") -> list[Column]:
    """Return the columns of the list of rules; the state, if any, is never dropped."""
    has_state = any(row[-1] for row in rows)
    return [replace(column, spare=False) if has_state and column.title == "state" else column for column in COLUMNS]


def list_row(entry: "Entry", documentation: "Documentation", error: RuleError | None = None) -> tuple[str | None, ...]:
    """Return the row of a rule in the list; `error` is why it cannot be read."""
    severity = f" [{documentation.severity}]" if documentation.severity else ""
    where = here(error.place.path) + _line_of(error.place.line) if error and error.place else ""
    words = (
        f"error {error.code} at {where}" if error else "",
        f"pack {entry.pack}" if entry.pack else "",
        "" if entry.in_force else "not in force",
    )
    state = ", ".join(word for word in words if word)
    return (entry.name, documentation.title + severity, entry.path.suffix.lstrip("."), documentation.since, state)


def manual_lines(manual: "Manual") -> "Iterator[RenderableType]":
    """Yield the lines about one rule: its description, documentation, dependencies and text."""
    from kg.rules.files import NOTATIONS  # noqa: PLC0415 - start-up time

    file = manual.file
    since = f", since {file.documentation.since}" if file.documentation.since else ""
    severity = f", reports a {file.documentation.severity}" if file.documentation.severity else ""
    yield Text.assemble((file.name, "bold"), f"  {NOTATIONS[file.notation]}{since}{severity}")
    yield Text(printable(file.documentation.title))
    for heading, text in manual.sections:
        yield Text()
        yield Text(heading, style="bold")
        yield from (Padding(printable(block), (0, 0, 0, 2), expand=False) for block in paragraphs(text))
    yield Text()
    yield _fields(manual)
    yield Text()
    wide = len(str(manual.lines[-1][0])) if manual.lines else 1
    yield from (Text.assemble((f"{number:>{wide}} | ", "dim"), printable(line)) for number, line in manual.lines)


def paragraphs(text: str) -> "Iterator[str]":
    """Yield the paragraphs, list items and indented lines of a text, each as one line, separated by empty lines.

    The terminal folds them, whatever the width of the source.
    """
    lines: list[str] = []
    for line in text.splitlines():
        apart = not line.strip() or line[:1].isspace() or _ITEM.match(line)
        continued = bool(lines) and line[:1].isspace() and bool(_ITEM.match(lines[0])) and not _ITEM.match(line.strip())
        if lines and apart and not continued:
            yield " ".join(lines)
            lines = []
        if not line.strip() or (line[:1].isspace() and not continued):
            yield line.rstrip()
        else:
            lines.append(line.strip())
    if lines:
        yield " ".join(lines)


def _fields(manual: "Manual") -> "Table":
    first, last = (manual.strata[0], manual.strata[-1]) if manual.strata else (0, 0)
    strata = f"{first}" if first == last else f"{first} to {last}"
    fields = (
        ("file", here(manual.file.path)),
        ("pack", manual.file.pack),
        ("reads", ", ".join(manual.reads)),
        ("absent", ", ".join(manual.absent)),
        ("derives", ", ".join(manual.derives)),
        ("stratum", f"{strata} of {manual.of_strata}" if manual.strata else "none"),
        ("fed by", ", ".join(manual.fed_by)),
        ("feeds", ", ".join(manual.feeds)),
        (
            "examples",
            "\n".join(
                f"{here(example.place.path)}:{example.place.line}  {example.title}" for example in manual.examples
            ),
        ),
    )
    table = Table.grid(padding=(0, 1))
    table.add_column(style="dim")
    table.add_column()
    for name, value in fields:
        if value:
            table.add_row(f"  {name:<9}", "\n".join(map(printable, value.splitlines())))
    return table


def result_lines(rule: str, results: "Iterable[Result]", *, every: bool) -> "Iterator[Text]":
    """Yield the results of a rule's examples: a line for the rule, and one for each relevant example."""
    listed = list(results)
    failed = [result for result in listed if not result.passed]
    ran = [result for result in listed if result.title]
    words = f"{len(failed)} of {len(listed)} failed" if failed else f"{count(len(listed), 'example')}"
    words = words if ran else "cannot be read"
    mark = ("FAIL", "bold red") if failed else ("ok  ", "green")
    yield Text.assemble(mark, "  ", (rule, "bold"), f"  {words}")
    for result in listed if every else failed:
        yield from _example_lines(result)


def _example_lines(result: "Result") -> "Iterator[Text]":
    title = printable(result.title or "the rule and its examples")
    if result.passed:
        yield Text.assemble(("      ok    ", "green"), title)
        return
    where = here(result.place.path) + (f":{result.place.line}" if result.place.line else "")
    yield Text.assemble(("      FAIL  ", "bold red"), title, "  ", (where, "dim"))
    if result.error:
        place = f" ({here(result.error.place.path)}{_line_of(result.error.place.line)})" if result.error.place else ""
        yield Text(f"            {result.error.code}: {printable(result.error.message)}{place}", style="red")
        yield from (Text(f"            {line}", style="dim") for line in (result.error.hint or "").splitlines())
    yield from (changed_line("-", text, "missing", indent=12) for text in result.missing)
    yield from (changed_line("+", text, "not expected", indent=12) for text in result.unexpected)
    for line in result.why_missing:
        yield changed_line("-", line.text, f"in no proof, line {line.place.line}", indent=12)
    if result.proof:
        yield Text("            the proof:", style="dim")
        yield from (Text(f"              {printable(line)}", style="dim") for line in result.proof)


def _line_of(line: int | None) -> str:
    return f":{line}" if line else ""


def changed_line(sign: str, text: str, about: str = "", *, indent: int = 0) -> "Text":
    """Return a line about something added (`+`) or removed (`-`)."""
    style = "green" if sign == "+" else "red"
    line = Text.assemble(" " * indent, (f"{sign} ", f"bold {style}"), (printable(text), style))
    return line.append(f"  {about}", style="dim") if about else line


def change_lines(changes: "Sequence[Changed]", view: "View") -> "Iterator[Text]":
    """Yield added or removed triples with labels of their parts, or names if labels are ambiguous."""
    # Labels are short, but may be shared: changes that read alike get the labels of parents too, then whole names.
    texts = [" ".join(_called(term, change, view) for term in _terms(change)) for change in changes]
    signs = [change.sign for change in changes]
    alike = Counter(zip(texts, signs, strict=True))
    placed = [" ".join(_placed(term, change, view) for term in _terms(change)) for change in changes]
    still_alike = Counter(zip(placed, signs, strict=True))
    for text, longer, change in zip(texts, placed, changes, strict=True):
        if alike[text, change.sign] == 1:
            clear = text
        else:
            longer_is_clear = still_alike[longer, change.sign] == 1
            clear = longer if longer_is_clear else spell_triple(change.triple, change.prefixes)
        yield changed_line(change.sign, clear, ", ".join(change.rules))


def _placed(term: "Term", change: "Changed", view: "View") -> str:
    """Return the label of a thing, with that of its parent."""
    name = _called(term, change, view)
    whole = NamedNode(term.value.partition("#")[0]) if isinstance(term, NamedNode) and "#" in term.value else None
    place = view.label(whole) if whole is not None and term != change.triple.predicate else ""
    return f"{name} (of {place})" if place and whole is not None and place != view.spelt(whole) else name


def _terms(change: "Changed") -> "tuple[Term, Term, Term]":
    return change.triple.subject, change.triple.predicate, change.triple.object


def _called(term: "Term", change: "Changed", view: "View") -> str:
    """Return the label of a thing, else its prefixed name; properties have prefixed names only."""
    label = view.spelt(term) if term == change.triple.predicate else view.label(term)
    return spell_term(term, change.prefixes) if label == view.spelt(term) else label


def difference_words(difference: "Difference") -> "Iterator[str]":
    """Yield the numbers of additions and removals by rule and in total."""
    by_rule = difference.by_rule
    longest = max(map(len, by_rule), default=0)
    for rule, (more, less) in by_rule.items():
        yield f"  {rule:<{longest}}  +{more:,} -{less:,}"
    if difference:
        come = count(difference.count("+"), "triple")
        yield f"{come} would be added, {difference.count('-'):,} would be removed; `kg rules run` applies the change"
    else:
        yield "nothing would change"


def element_table(rule: "RuleProfile") -> "Iterator[RenderableType]":
    """Yield the elements of a rule's bodies with their rows and seconds, in the order of the text."""
    several = any(element.part > 1 for element in rule.elements)
    columns = (
        *numbers("run", "rows in", "rows out", "seconds"),
        *((Column("part", "number"),) if several else ()),
        Column("line", "number", spare=1),
        Column("element"),
    )
    rows = [
        (
            "-" if each.order is None else each.order,
            each.rows_in,
            each.rows_out,
            f"{each.seconds:.4f}",
            *((each.part,) if several else ()),
            each.place.line,
            each.text,
        )
        for each in rule.elements
    ]
    yield Text()
    yield Text(f"{rule.name}, applied once to all that is known", style="bold")
    yield make_table(columns, rows)


def coverage_lines(rule: "RuleCoverage") -> "Iterator[RenderableType]":
    """Yield the lines about a rule with unused parts."""
    yield Text.assemble((rule.name, "bold"), f"  {rule.covered} of {count(rule.parts, 'part')}")
    yield from (Padding(Text(words), (0, 0, 0, 4), expand=False) for words in gap_words(rule))


def gap_words(rule: "RuleCoverage") -> list[str]:
    """Describe the parts of a rule that never had an effect."""
    words = []
    stopped = {gap.part for gap in rule.gaps if gap.kind == "element"}
    for gap in rule.gaps:
        part = f"part {gap.part}: " if rule.rules > 1 else ""
        line = f"{here(gap.place.path)}:{gap.place.line}: " if gap.place.line else ""
        if gap.kind == "element":
            words.append(printable(f"{part}{line}nothing passes {gap.text}"))
        elif gap.kind == "head" and gap.part not in stopped:
            words.append(printable(f"{part}{line}never derives {gap.text}"))
    return words


def run_words(report: "RunReport") -> str:
    """Describe a run in one line."""
    would = "would be " if report.dry_run else ""
    return (
        f"{report.mode} run: {count(report.inferred, 'triple')} inferred from {report.asserted:,}; "
        f"{report.added:,} {would}added, {report.removed:,} {would}removed; in {report.seconds.total:.2f} s"
    )


def share_rows(shares: "Iterable[Share]") -> "Iterator[tuple[str, str, str]]":
    """Yield the numbers of additions and removals by rule."""
    for share in shares:
        name = " or ".join(share.rules) or "(no rule in force)"
        yield name, f"+{share.added:,}", f"-{share.removed:,}"


def work_words(report: "RunReport", derived: int, rules: int) -> "Iterator[str]":
    """Yield the lines about a run in which `derived` of `rules` files inferred something."""
    strata = count(report.strata, "stratum", "strata")
    yield f"{derived:,} of {count(rules, 'rule')} derived something, in {strata}" if rules else strata
    phases = report.seconds
    yield f"read in {phases.read:.2f} s, evaluated in {phases.evaluate:.2f} s, written in {phases.write:.2f} s"
