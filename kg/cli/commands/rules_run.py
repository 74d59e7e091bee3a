"""`kg rules run`, and reports: `plan`, `graph`, `profile` and `coverage`."""

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Final

from kg.cli.commands.rules import Chosen
from kg.cli.diagnostics import note, say
from kg.cli.options import Json, OutputFile, UpdateUrl, option, require_one_of, with_settings
from kg.cli.output import Column, json_line, json_lines, listing, numbers, show, terminal, write_text
from kg.cli.supervising import supervise
from kg.errors import UsageError
from kg.lazily import lazily
from kg.render.text import count
from kg.settings import Settings
from kg.store.opening import layout_of

if TYPE_CHECKING:
    from kg.rules.remote.running import RemoteReport


with lazily():
    from kg.cli.commands.rules import coverage_lines, element_table, gap_words, run_words, share_rows, work_words
    from kg.cli.progress import waiting
    from kg.pipeline import inferring
    from kg.pipeline.authoring import attempt
    from kg.pipeline.inferring import unchanged
    from kg.pipeline.reasoning import division, ontology_schema, rules_over
    from kg.rules.authoring.graph import graph_objects, graph_picture, mermaid, rule_graph
    from kg.rules.authoring.library import Library
    from kg.rules.authoring.profiling import profile as profiled
    from kg.rules.authoring.profiling import profile_objects
    from kg.rules.authoring.runs import remote_objects, remote_strata, rule_runs, run_objects, shares
    from kg.rules.authoring.starting import choose
    from kg.rules.authoring.testing import cover, coverage_objects
    from kg.rules.engine.limits import Limits
    from kg.rules.partitions import verdicts
    from kg.rules.reports import RunReport, nothing_changed
    from kg.store.opening import reading


_CHANGES: Final = (Column("rule", "name"), Column("added", "number"), Column("removed", "number"))
_COLUMNS: Final = (
    Column("rule", "name"),
    *numbers("derived", "seconds"),
    Column("rounds", "number", spare=1),
    Column("stratum", "number", spare=1),
)
_REMOTE_COLUMNS: Final = (*numbers("stratum", "derived", "rounds", "seconds"), Column("rules"))

Full = Annotated[bool, option("--full", "Evaluate everything again, not only what changed.")]
DryRun = Annotated[bool, option("--dry-run", "Write nothing.")]
Remote = Annotated[str | None, option("--remote URL", "Run on this SPARQL 1.1 server.")]
Verbose = Annotated[bool, option("--all --verbose -v", "Show the results of each rule and the time of each step.")]
Data = Annotated[list[str] | None, option("--data FILE", "Infer from this RDF file instead; may be repeated.")]
Output = Annotated[str | None, option("--output -o FILE", "Output of --data, as N-Triples.")]
MaxTriples = Annotated[str | None, option("--max-triples N", "Stop if more than N triples are inferred.")]


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


_FORMATS: Final = ("svg", "mermaid", "json")
_ENDINGS: Final = {".svg": "svg", ".mmd": "mermaid", ".mermaid": "mermaid", ".json": "json", ".jsonl": "json"}
_PROFILE: Final = (
    Column("rule", "name"),
    Column("seconds", "number"),
    Column("share", "number", spare=1),
    *numbers("derived", "rounds"),
    Column("stratum", "number", spare=1),
    Column("rules", "number", spare=1),
)
_COVERAGE: Final = (Column("rule", "name"), Column("parts", "number"), Column("covered", "number"), Column("never"))

Cluster = Annotated[bool, option("--cluster", "For a graph divided by source; the only plan so far.")]
Form = Annotated[str | None, option("--format FORMAT", f"One of {', '.join(_FORMATS)}.")]


@with_settings("rules", "rule_families")
def graph(
    chosen: Chosen = None, *, settings: Settings, output: OutputFile = None, form: Form = None, json: Json = False
) -> None:
    """Draw which rules feed which, as SVG, Mermaid or JSON.

    Each rule is drawn after its inputs, with its stratum. A dashed line with a bar leads to a rule that uses negation
    or aggregation. Named rules are drawn with the rules that feed them and those that they feed. For example:

        kg rules graph -o rules.svg
        kg rules graph communication --format mermaid
    """
    form = _form("json" if json else form, output)
    library = Library.of(settings)
    entries = choose(library, chosen or ())
    drawn = rule_graph(library.with_those_in_force(entries), ontology_schema(settings))
    if chosen:
        drawn = drawn.around({entry.name for entry in entries})
    if form == "json":
        text = "".join(json_line(each) for each in graph_objects(drawn))
    elif form == "mermaid":
        text = mermaid(drawn)
    else:
        text = graph_picture(drawn, f"Rules: {', '.join(chosen)}" if chosen else "Rules")
    write_text(text, output)
    if output and output != "-":
        say(f"wrote {output}: {count(len(drawn.rules), 'rule')}")


@with_settings("rules", "rule_families", "base", "store")
def plan(
    *,
    settings: Settings,
    cluster: Cluster = True,  # noqa: ARG001 - the only plan there is
    json: Json = False,
) -> None:
    """Show which rules can run on each source alone, and why not.

    A graph that is divided among machines has each source, with its launch files, in one part, and a copy of the
    ontologies and of what sources share in each. A local rule infers the same from the parts as from the whole. The
    others need a join over all parts. Which properties stay within a source is read from the store. For example:

        kg rules plan --cluster
        kg rules plan --json
    """
    with reading(settings) as snapshot:
        parts, asserted = division(settings, snapshot)
        judged = verdicts(rules_over(settings, snapshot).rules, parts, asserted)
    objects = (
        {"rule": one.rule.name, "part": one.rule.part, "local": one.is_local, "why": one.reason} for one in judged
    )
    rows = [(str(one.rule), "a source" if one.is_local else "all together", one.reason) for one in judged]
    listing((Column("rule", "name"), Column("needs"), Column("why")), rows, objects=objects if json else None)
    local = sum(one.is_local for one in judged)
    note(f"{local:,} of {count(len(judged), 'rule')} are local to a source")
    if parts.number < 2:  # noqa: PLR2004 - one source shows no property that leads to another
        note("the store has one source; only one with several shows which properties lead from one to another")


def _form(form: str | None, output: str | None) -> str:
    """Return the format that is asked for, or that the ending of the file names; SVG without either."""
    if form is None:
        ending = Path(output or "").suffix
        if ending and ending not in _ENDINGS:
            hint = f"Write to {', '.join(f'*{suffix}' for suffix in _ENDINGS)}, or name one of them with --format."
            raise UsageError("KG003", f"unsupported picture format `{ending}`", hint=hint)
        return _ENDINGS.get(ending, "svg")
    require_one_of(form, _FORMATS, "format")
    return form


@with_settings("rules", "rule_families", "timeout", "store")
def profile(chosen: Chosen = None, *, settings: Settings, json: Json = False) -> None:
    """Run the rules in memory and show their cost, most expensive first.

    Shows seconds, triples and rounds. Nothing is written. For named rules, also shows the cost of each part of their
    bodies: the rows before and after it. For example:

        kg rules profile
        kg rules profile communication/feeds
    """
    with attempt(settings, chosen or ()) as trial:
        profiled_run = profiled(trial.bench, trial.files, [file.name for file in trial.chosen], trial.limits)
    if json:
        json_lines(profile_objects(profiled_run))
        return
    detailed = [rule for rule in profiled_run.rules if rule.elements]
    total = sum(rule.seconds for rule in profiled_run.rules) or 1.0
    rows = [
        (
            rule.name,
            f"{rule.seconds:.4f}",
            f"{rule.seconds / total:.0%}",
            rule.derived,
            rule.rounds,
            rule.stratum,
            rule.rules,
        )
        for rule in (detailed or profiled_run.rules)
    ]
    listing(_PROFILE, rows)
    for rule in detailed:
        show(*element_table(rule))
    seconds = f"{profiled_run.reading:.2f} s reading, {profiled_run.evaluating:.2f} s evaluating"
    say(f"{count(profiled_run.asserted, 'triple')} read, {profiled_run.inferred:,} inferred: {seconds}")
    if terminal() and not detailed:
        note("`kg rules profile NAME` shows the parts of one")


@with_settings("rules", "rule_families", "timeout", "store")
def coverage(chosen: Chosen = None, *, settings: Settings, json: Json = False) -> None:
    """Show the rules, and parts of rules, that never matched in this store.

    Parts are the elements of bodies and the triples of heads. A rule with UNION or OPTIONAL counts as several. For a
    rule that never fires, shows the first element without matches. For example:

        kg rules coverage
        kg rules coverage capability
    """
    with attempt(settings, chosen or ()) as trial:
        covered = cover(trial.bench, trial.files, trial.chosen, trial.limits)
    if json:
        json_lines(coverage_objects(covered))
        return
    lacking = [rule for rule in covered.rules if rule.gaps]
    if terminal():
        for rule in lacking:
            show(*coverage_lines(rule))
    else:
        listing(_COVERAGE, [(rule.name, rule.parts, rule.covered, "; ".join(gap_words(rule))) for rule in lacking])
    fired = f"{covered.fired:,} of {count(len(covered.rules), 'rule')} fired"
    say(f"{fired}; {covered.share:.0%} of their parts did something")
