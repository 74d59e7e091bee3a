"""`kg rules new`, `list`, `show`, `lsp`, `compile` and `diff`: begin rules, read them, see what they would change."""

import os
import shlex
import sys
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Final

import typer

from kg.cli.completion import rules as rule_names
from kg.cli.diagnostics import note, report, say
from kg.cli.options import Json, RuleName, Store, argument, option, require_one_of, session, takes, with_settings
from kg.cli.output import json_lines, listing, show, terminal, write
from kg.errors import Exit, GraphError, Place, RuleError
from kg.lazily import lazily
from kg.render.text import count
from kg.settings import DECLARED, Settings

if TYPE_CHECKING:
    from kg.rules.authoring.differences import Difference
    from kg.rules.explain.view import View


with lazily():
    from kg.cli.rules_view import change_lines, difference_words, here, list_columns, list_row, manual_lines
    from kg.editors.source import Source
    from kg.pipeline.authoring import attempt
    from kg.pipeline.reasoning import ontology_schema
    from kg.rules import printing
    from kg.rules.authoring.differences import difference, difference_objects
    from kg.rules.authoring.library import Library
    from kg.rules.authoring.manual import documented, entry_object, manual, manual_object
    from kg.rules.authoring.naming import choose, find_rule
    from kg.rules.authoring.starting import start
    from kg.rules.folders import own_folder


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
