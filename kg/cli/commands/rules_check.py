"""`kg rules check`: what is wrong with rules before they run."""

import sys
from collections import Counter
from contextlib import ExitStack
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from kg.cli.diagnostics import colored, render, say
from kg.cli.options import Form, Json, Level, is_given, require_valid, with_settings
from kg.cli.output import json_lines, write
from kg.codes import SEVERITIES
from kg.errors import Exit, StoreError
from kg.lazily import lazily
from kg.render.text import count
from kg.settings import Settings
from kg.similar import unknown
from kg.store.opening import reading

if TYPE_CHECKING:
    from collections.abc import Sequence

    from kg.rules.checks.finding import Finding
    from kg.rules.checks.run import Read

with lazily():
    from kg.pipeline.reasoning import check_context, rule_folders
    from kg.render.sarif import annotation
    from kg.resources import folder
    from kg.rules.checks.finding import as_object, remark, sarif
    from kg.rules.checks.run import check as run
    from kg.rules.checks.run import read_all
    from kg.rules.folders import families_in_force
    from kg.rules.reading import packs

Names = Annotated[list[str] | None, typer.Argument(metavar="[NAME]...", help="Rules, families, files or folders.")]
Every = Annotated[bool, typer.Option("--all", "-a", help="Check your rules, packs and the rules that kg ships.")]


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
    _write(shown, form, checked)
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


def _write(findings: "Sequence[Finding]", form: str, checked: int) -> None:
    if form == "json":
        json_lines(map(as_object, findings))
    elif form == "sarif":
        json_lines([sarif(findings, Path.cwd())])
    elif form == "github":
        for one in findings:
            write(annotation(remark(one)))
    else:
        for one in findings:
            write(render(one.error, color=colored(sys.stdout), severity=one.severity))
            write()
        sums = Counter(one.severity for one in findings)
        totals = ", ".join(count(sums[severity], severity) for severity in SEVERITIES if sums[severity])
        say(f"{count(checked, 'rule')} checked: {totals or 'nothing wrong'}")
