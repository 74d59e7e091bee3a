"""`kg rules run`: infer, and write what follows into the store."""

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Final

import typer

from kg.cli.diagnostics import note, say
from kg.cli.options import Json, UpdateUrl, with_settings
from kg.cli.output import Column, json_lines, listing, terminal
from kg.cli.supervising import supervise
from kg.errors import UsageError
from kg.lazily import lazily
from kg.render.text import count
from kg.settings import Settings
from kg.store.opening import layout_of

if TYPE_CHECKING:
    from kg.rules.remote.running import RemoteReport
    from kg.rules.reports import RunReport

with lazily():
    from kg.cli.progress import waiting
    from kg.cli.rules_view import run_words, share_rows, work_words
    from kg.pipeline import inferring
    from kg.pipeline.inferring import unchanged
    from kg.rules.authoring.runs import remote_objects, remote_strata, rule_runs, run_objects, shares
    from kg.rules.engine.limits import Limits
    from kg.rules.reports import nothing_changed

_CHANGES: Final = (Column("rule", "name"), Column("added", "number"), Column("removed", "number"))
_COLUMNS: Final = (
    Column("rule", "name"),
    Column("derived", "number"),
    Column("seconds", "number"),
    Column("rounds", "number", spare=1),
    Column("stratum", "number", spare=1),
)
_REMOTE_COLUMNS: Final = (
    Column("stratum", "number"),
    Column("derived", "number"),
    Column("rounds", "number"),
    Column("seconds", "number"),
    Column("rules"),
)

Full = Annotated[bool, typer.Option("--full", help="Evaluate everything again, not only what changed.")]
DryRun = Annotated[bool, typer.Option("--dry-run", help="Write nothing.")]
Remote = Annotated[str | None, typer.Option("--remote", metavar="URL", help="Run on this SPARQL 1.1 server.")]
Verbose = Annotated[
    bool, typer.Option("--all", "--verbose", "-v", help="Show the results of each rule and the time of each step.")
]
Data = Annotated[
    list[str] | None,
    typer.Option("--data", metavar="FILE", help="Infer from this RDF file instead; may be repeated."),
]
Output = Annotated[str | None, typer.Option("--output", "-o", metavar="FILE", help="Output of --data, as N-Triples.")]
MaxTriples = Annotated[
    str | None, typer.Option("--max-triples", metavar="N", help="Stop if more than N triples are inferred.")
]


@with_settings("memory", "rules", "rule_families", "timeout", "store")
def run(  # noqa: PLR0913 - the options of a command
    *,
    settings: Settings,
    full: Full = False,
    dry_run: DryRun = False,
    remote: Remote = None,
    update_url: UpdateUrl = None,
    data: Data = None,
    output: Output = None,
    max_triples: MaxTriples = None,
    verbose: Verbose = False,
    json: Json = False,
) -> None:
    """Run the active rules and write what they infer into the store.

    Evaluates only what changed since the last run if that is less work. A run that is interrupted or reaches a limit
    leaves the store unchanged. Reports the rules whose triples were added or removed; several rules if their heads are
    alike. For example:

        kg rules run
        kg rules run --dry-run
        kg rules run --remote http://localhost:7878/query --update-url http://localhost:7878/update
        kg rules run --data all.ttl --output inferred.nt
    """
    _agree(remote=remote, update_url=update_url, data=data, output=output, dry_run=dry_run)
    limits = limits_of(settings, max_triples)
    usual = not (full or dry_run or remote or data or max_triples)
    last = unchanged(settings, layout_of(settings)) if usual else None
    if last is not None:
        _show(nothing_changed(last.asserted, last.inferred, last.strata), verbose=verbose, json=json)
        return
    if settings.memory:
        supervise(settings.memory)

    with waiting("running the rules"):
        if remote:
            answer = inferring.run_on_server(settings, remote, update_url, limits=limits)
        elif data:
            target = Path(output) if output and not dry_run else None
            report = inferring.run_on_files(settings, [Path(file) for file in data], target, limits=limits)
        else:
            report = inferring.run_on_store(settings, full=full, dry_run=dry_run, limits=limits)
    if remote:
        _show_remote(answer, json=json)
    else:
        _show(report, verbose=verbose, json=json)


def limits_of(settings: Settings, max_triples: str | None = None) -> "Limits":
    """Return the limits of a run: a deadline only where one is set, for it is queries that the default is for."""
    if max_triples is not None and not (max_triples.isdecimal() and int(max_triples)):
        raise UsageError(
            "KG003", f"--max-triples is `{max_triples}`, but must be a number above 0", hint="Give a number."
        )
    explicit = settings.origin("timeout").kind != "default"
    return Limits((settings.timeout or None) if explicit else None, int(max_triples) if max_triples else None)


def _agree(
    *, remote: str | None, update_url: str | None, data: list[str] | None, output: str | None, dry_run: bool
) -> None:
    """Raise KG003 for options that do not go together."""
    problem = None
    if remote and (data or output or dry_run):
        problem = "--remote conflicts with --data, --output and --dry-run"
    elif update_url and not remote:
        problem = "--update-url needs --remote"
    elif output and not data:
        problem = "--output needs --data"
    elif data and not output and not dry_run:
        problem = "--data needs --output FILE, or --dry-run"
    if problem:
        raise UsageError("KG003", problem, hint="See `kg rules run --help`.")


def _show(report: "RunReport", *, verbose: bool, json: bool) -> None:
    changes = shares(report)
    if json:
        json_lines(run_objects(report, changes))
        return
    say(run_words(report))
    if changes:
        listing(_CHANGES, share_rows(changes))
    if verbose:
        did = rule_runs(report.rules)
        rows = [(one.rule, one.derived, f"{one.seconds:.4f}", one.rounds, one.stratum) for one in did]
        if did:
            listing(_COLUMNS, rows)
        else:
            note("incremental runs have no results per rule; use --full")
        for line in work_words(report, sum(rule.derived > 0 for rule in did), len(did)):
            say(line)
    if terminal() and not report.dry_run and report.generation is not None:
        note("`kg why` explains a fact; `kg rules profile` shows what each rule costs")


def _show_remote(report: "RemoteReport", *, json: bool) -> None:
    if json:
        json_lines(remote_objects(report))
        return
    rows = [
        (one.number, one.derived, one.rounds, f"{one.seconds:.3f}", ", ".join(dict.fromkeys(one.rules)))
        for one in remote_strata(report)
        if one.derived
    ]
    listing(_REMOTE_COLUMNS, rows)
    say(f"{count(report.inferred, 'triple')} inferred on the server in {report.seconds:.2f} s")
