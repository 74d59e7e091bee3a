"""`kg rules diff`: what rules as they are on disk would change in the store."""

from typing import TYPE_CHECKING

import typer

from kg.cli.commands.rules import Chosen
from kg.cli.diagnostics import note, say
from kg.cli.options import Json, with_settings
from kg.cli.output import json_lines, show
from kg.errors import Exit
from kg.lazily import lazily
from kg.settings import Settings

if TYPE_CHECKING:
    from kg.rules.authoring.differences import Difference
    from kg.rules.explain.view import View

with lazily():
    from kg.cli.rules_view import change_lines, difference_words
    from kg.pipeline.authoring import attempt
    from kg.rules.authoring.differences import difference, difference_objects


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
