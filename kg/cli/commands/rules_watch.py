"""`kg rules watch`: check, test and compare rules whenever they are saved."""

import sys
import time
from typing import TYPE_CHECKING, Final

import typer

from kg.cli.commands.rules import Chosen
from kg.cli.diagnostics import colored, render, report, say
from kg.cli.options import Families, Rules, Store
from kg.cli.output import show, terminal, write
from kg.cli.session import session
from kg.errors import RuleError
from kg.render.text import count

if TYPE_CHECKING:
    from kg.pipeline.watching import Glance

_CLEAR: Final = "\x1b[2J\x1b[H"
"""Clears the screen; what was scrolled out of it stays."""
_CHANGES: Final = 20
"""How many triples of a difference are shown."""


def watch(
    context: typer.Context,
    chosen: Chosen = None,
    *,
    rules: Rules = None,
    rule_families: Families = None,
    store: Store = None,
) -> None:
    """Check and test rules on every save, and show their effect on the store.

    Rules and their examples are checked for changes five times a second. Without a store, effects are not shown.
    Nothing is written. Press Ctrl-C to stop. For example:

        kg rules watch
        kg rules watch wiring/listens-to
    """
    from kg.pipeline.watching import glances  # noqa: PLC0415 - start-up time

    settings = session(context).settings(store=store, rules=rules, rule_families=rule_families)
    try:
        for glance in glances(settings, chosen or ()):
            _show(glance)
            sys.stdout.flush()
    except KeyboardInterrupt:
        say("\nstopped")


def _show(glance: "Glance") -> None:
    from kg.cli.commands.rules_testing import show_results  # noqa: PLC0415 - start-up time

    if terminal():
        sys.stdout.write(_CLEAR)
    names = ", ".join((*glance.names, *(f"{name} (gone)" for name in glance.gone))) or "no rules of your own yet"
    write(f"{time.strftime('%H:%M:%S')}  {names}")
    for finding in glance.findings:
        error = RuleError(finding.code, finding.message, place=finding.place, hint=finding.hint)
        write(render(error, color=colored(sys.stdout), severity=finding.severity))
    show_results(glance.results, every=False)
    if glance.problem:
        report(glance.problem)
    if glance.difference is not None:
        _show_difference(glance)
    say(f"in {glance.seconds:.2f} s; watching; press Ctrl-C to stop")


def _show_difference(glance: "Glance") -> None:
    from kg.cli.rules_view import change_lines, difference_words  # noqa: PLC0415 - start-up time

    if glance.difference is None or glance.view is None:
        return
    changes = glance.difference.changes
    if changes:
        show(*change_lines(changes[:_CHANGES], glance.view))
    if len(changes) > _CHANGES:
        write(f"  and {count(len(changes) - _CHANGES, 'more change')}; `kg rules diff` shows them")
    for line in difference_words(glance.difference):
        write(line)
