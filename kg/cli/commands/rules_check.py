"""`kg rules check`, `test` and `watch`: what is wrong with rules, before they run and by their examples."""

import sys
import time
from collections.abc import Iterable, Iterator, Sequence
from contextlib import ExitStack
from dataclasses import replace
from itertools import groupby
from pathlib import Path
from typing import Annotated, Final

import typer

from kg.cli.commands.rules import Chosen
from kg.cli.diagnostics import colored, note, render, report, say
from kg.cli.options import Json, argument, is_given, option, with_settings
from kg.cli.output import json_lines, show, terminal, write
from kg.cli.remarks import Form, Level, require_valid, totals, write_remarks
from kg.codes import SEVERITIES
from kg.errors import Exit, StoreError
from kg.lazily import lazily
from kg.render.text import count, some
from kg.settings import Settings
from kg.similar import unknown
from kg.store.opening import reading

with lazily():
    from kg.cli.commands.rules import change_lines, difference_words, result_lines
    from kg.pipeline.reasoning import check_context, rule_folders
    from kg.pipeline.watching import Glance, glances
    from kg.resources import folder
    from kg.rules.authoring.library import Entry, Library
    from kg.rules.authoring.starting import choose
    from kg.rules.authoring.testing import Result, parted, result_object, run_examples
    from kg.rules.checks.finding import Finding, as_object, remark
    from kg.rules.checks.run import Read, read_all
    from kg.rules.checks.run import check as run
    from kg.rules.reading import families_in_force, packs


Names = Annotated[list[str] | None, argument("[NAME]...", "Rules, families, files or folders.")]
Every = Annotated[bool, option("--all -a", "Check your rules, packs and the rules that kg ships.")]


@with_settings("rules", "rule_families", "timeout", "store")
def check(  # noqa: PLR0913 - the options of a command
    names: Names = None,
    *,
    settings: Settings,
    every: Every = False,
    form: Form = "text",
    level: Level = "note",
    json: Json = False,
) -> None:
    """Check rules: names, safety, strata, dead rules, documentation.

    Without names, checks your own rules and packs, or the rules that kg ships if you have none. Terms are checked
    against the ontologies, and against the store if there is one. The store is searched for a match of each rule for 5
    seconds, or for `--timeout`. Exits with 1 if there are errors or warnings. For example:

        kg rules check
        kg rules check mine/feeds --level warning
        kg rules check --format sarif > rules.sarif
    """
    form = "json" if json else form
    require_valid(form, level)
    from kg.rules.checks.finding import SECONDS  # noqa: PLC0415 - start-up time

    seconds = (settings.timeout or None) if is_given(settings, "timeout") else SECONDS
    findings, checked = _check(settings, names or [], seconds, every=every)
    shown = [one for one in findings if SEVERITIES.index(one.severity) <= SEVERITIES.index(level)]
    root = Path.cwd() if form == "sarif" else None
    remarks = (remark(one, root) for one in shown)
    write_remarks(form, lines=_lines(shown), objects=map(as_object, shown), remarks=remarks)
    if form == "text":
        found = totals(one.severity for one in shown)
        say(f"{count(checked, 'rule')} checked: {found or 'nothing wrong'}")
    if any(one.severity != "note" for one in shown):
        raise typer.Exit(Exit.FOUND)


def _check(settings: Settings, names: list[str], seconds: float | None, *, every: bool) -> "tuple[list[Finding], int]":
    folders, installed = rule_folders(settings), packs()
    families = families_in_force(settings)
    files = read_all(folders, installed, families)
    others = files.outside(names)
    files = read_all([*folders, *others], installed, families) if others else files
    wanted = _wanted(files, names, every=every)
    with ExitStack() as stack:
        try:
            snapshot = stack.enter_context(reading(settings))
        except StoreError:
            snapshot = None
        findings = run(files, replace(check_context(settings, snapshot), seconds=seconds), wanted)
    return findings, len(wanted)


def _wanted(files: "Read", names: list[str], *, every: bool) -> list[str]:
    """Return the names of the rules that are meant by names, families and files."""
    paths = dict(files.paths)
    if not names:
        return (not every and list(dict.fromkeys(files.others_than(folder("rules"))))) or list(paths)
    wanted: list[str] = []
    for name in names:
        chosen = files.named(name)
        if not chosen:
            raise unknown("rule", name, paths, otherwise="`kg rules list` lists the rules.")
        wanted += chosen
    return list(dict.fromkeys(wanted))


def _lines(findings: "Iterable[Finding]") -> "Iterator[str]":
    for one in findings:
        yield render(one.error, color=colored(sys.stdout), severity=one.severity)
        yield ""


_FEW = 3  # so many rules without examples are named; of more, how many there are

Verbose = Annotated[bool, option("--verbose -v", "Show all examples, not only failures.")]

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
def try_rules(chosen: Chosen = None, *, settings: Settings, verbose: Verbose = False, json: Json = False) -> None:
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
