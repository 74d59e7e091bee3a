"""`kg rules test` and `kg rules watch`: do rules infer what their examples say, and what do they change?"""

import sys
import time
from itertools import groupby
from typing import TYPE_CHECKING, Annotated, Final

import typer

from kg.cli.commands.rules import Chosen
from kg.cli.diagnostics import colored, note, render, report, say
from kg.cli.options import Json, with_settings
from kg.cli.output import json_lines, show, terminal, write
from kg.errors import Exit
from kg.lazily import lazily
from kg.render.text import count, some
from kg.settings import Settings

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence

    from kg.pipeline.watching import Glance
    from kg.rules.authoring.library import Entry
    from kg.rules.authoring.testing import Result

with lazily():
    from kg.cli.rules_view import change_lines, difference_words, result_lines
    from kg.pipeline.watching import glances
    from kg.rules.authoring.library import Library
    from kg.rules.authoring.naming import choose
    from kg.rules.authoring.testing import parted, result_object, run_examples

_FEW = 3  # so many rules without examples are named; of more, how many there are

Verbose = Annotated[bool, typer.Option("--verbose", "-v", help="Show all examples, not only failures.")]

_CLEAR: Final = "\x1b[2J\x1b[H"  # clears the screen; what was scrolled out of it stays
_CHANGES: Final = 20  # how many triples of a difference are shown
_FAILED: Final = "KG220"


@with_settings("rules", "rule_families", "store")
def watch(chosen: Chosen = None, *, settings: Settings) -> None:
    """Check and test rules on every save, and show their effect on the store.

    Rules and their examples are checked for changes five times a second. Without a store, effects are not shown.
    Nothing is written. Press Ctrl-C to stop. For example:

        kg rules watch
        kg rules watch wiring/listens-to
    """
    try:
        for glance in glances(settings, chosen or ()):
            _show(glance)
            sys.stdout.flush()
    except KeyboardInterrupt:
        say("\nstopped")


def _show(glance: "Glance") -> None:
    if terminal():
        sys.stdout.write(_CLEAR)
    names = ", ".join((*glance.names, *(f"{name} (gone)" for name in glance.gone))) or "no rules of your own yet"
    write(f"{time.strftime('%H:%M:%S')}  {names}")
    for finding in glance.findings:
        write(render(finding.error, color=colored(sys.stdout), severity=finding.severity))
    show_results(glance.results, every=False)
    if glance.problem:
        report(glance.problem)
    if glance.difference is not None and glance.view is not None:
        changes = glance.difference.changes
        if changes:
            show(*change_lines(changes[:_CHANGES], glance.view))
        if len(changes) > _CHANGES:
            write(f"  and {count(len(changes) - _CHANGES, 'more change')}; `kg rules diff` shows them")
        for line in difference_words(glance.difference):
            write(line)
    say(f"in {glance.seconds:.2f} s; watching; press Ctrl-C to stop")


@with_settings("rules", "rule_families")
def try_rules(
    chosen: Chosen = None,
    *,
    settings: Settings,
    verbose: Verbose = False,
    json: Json = False,
) -> None:
    """Run the examples of rules and show what differs.

    The examples of rules/FAMILY/NAME.rq are in rules/FAMILY/NAME.md. Each lists the given triples and the triples
    inferred from them. No store is needed. Exits with 1 if an example fails. For example:

        kg rules test
        kg rules test wiring/listens-to
        kg rules test rules/wiring
    """
    begin = time.perf_counter()
    library = Library.of(settings)
    entries = choose(library, chosen or ())
    with_examples, without = parted(entries)
    results = run_examples(entries, library)
    done = []
    if json:
        for result in results:
            done.append(result)
            json_lines([result_object(result)])
    else:
        done = show_results(results, every=verbose or len(with_examples) == 1)
    for error in library.problems:
        report(error)
    summary(done, without, time.perf_counter() - begin)
    if library.problems or not all(result.passed for result in done):
        raise typer.Exit(Exit.FOUND)


def show_results(results: "Iterable[Result]", *, every: bool) -> "list[Result]":
    """Show results rule by rule as they come, and return them; `every`: also the examples that passed."""
    done: list[Result] = []
    for rule, group in groupby(results, key=lambda result: result.rule):
        results_of_rule = list(group)
        done += results_of_rule
        show(*result_lines(rule, results_of_rule, every=every))
    return done


def summary(done: "Sequence[Result]", without: "Sequence[Entry]", seconds: float) -> None:
    """Say how all went, which rules cannot be read, and which have no examples."""
    ran = [result for result in done if result.title]
    broken = {result.rule for result in done if not result.title}
    failed = sum(not result.passed for result in ran)
    verdict = f"{failed:,} failed ({_FAILED})" if failed else "all passed" if ran or not broken else "none ran"
    if broken:
        verdict += f", {count(len(broken), 'rule')} unreadable"
    rules = len({result.rule for result in ran})
    say(f"{count(len(ran), 'example')} of {count(rules, 'rule')}: {verdict} in {seconds:.2f} s")
    without = [entry for entry in without if entry.name not in broken]
    if without:
        note(f"without examples: {some([entry.name for entry in without], _FEW)}")
