"""`kg rules new`, `list` and `show`: begin a rule, see which there are, read one."""

import shlex
from typing import Annotated

import typer

from kg.cli.completion import rules as rule_names
from kg.cli.diagnostics import note, report
from kg.cli.options import Json, RuleName, takes, with_settings
from kg.cli.output import json_lines, listing, show, terminal, write
from kg.cli.session import session
from kg.errors import Exit
from kg.lazily import lazily
from kg.render.text import count
from kg.settings import DECLARED, Settings

with lazily():
    from kg.cli.rules_view import here, list_columns, list_row, manual_lines
    from kg.pipeline.reasoning import ontology_schema
    from kg.rules.authoring.library import Library
    from kg.rules.authoring.manual import documented, entry_object, manual, manual_object
    from kg.rules.authoring.naming import choose, find_rule
    from kg.rules.authoring.starting import start
    from kg.rules.folders import own_folder

Chosen = Annotated[
    list[str] | None,
    typer.Argument(
        metavar="RULE", help="Rules, families, files or folders; by default all rules.", autocompletion=rule_names
    ),
]
NewName = Annotated[str, typer.Argument(metavar="FAMILY/NAME", help="Name of the new rule.")]
Notation = Annotated[str, typer.Option("--notation", metavar="NOTATION", help="rq (SPARQL), ttl (SHACL) or srl.")]


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
