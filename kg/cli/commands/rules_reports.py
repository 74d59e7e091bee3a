"""`kg rules graph`, `profile` and `coverage`: how rules hang together, what they cost, which never fire."""

from pathlib import Path
from typing import Annotated, Final

import typer

from kg.cli.commands.rules import Chosen
from kg.cli.diagnostics import note, say
from kg.cli.options import Json, OutputFile, require_one_of, with_settings
from kg.cli.output import Column, json_line, json_lines, listing, show, terminal, write_text
from kg.errors import UsageError
from kg.lazily import lazily
from kg.render.text import count
from kg.settings import Settings
from kg.store.opening import reading

with lazily():
    from kg.cli.rules_view import coverage_lines, element_table, gap_words
    from kg.pipeline.authoring import attempt
    from kg.pipeline.reasoning import division, ontology_schema, rules_over
    from kg.rules.authoring.coverage import cover, coverage_objects
    from kg.rules.authoring.graph import graph_objects, graph_picture, mermaid, rule_graph
    from kg.rules.authoring.library import Library
    from kg.rules.authoring.naming import choose
    from kg.rules.authoring.profiling import profile as profiled
    from kg.rules.authoring.profiling import profile_objects
    from kg.rules.partitions import verdicts

_FORMATS: Final = ("svg", "mermaid", "json")
_ENDINGS: Final = {".svg": "svg", ".mmd": "mermaid", ".mermaid": "mermaid", ".json": "json", ".jsonl": "json"}
_PROFILE: Final = (
    Column("rule", "name"),
    Column("seconds", "number"),
    Column("share", "number", spare=1),
    Column("derived", "number"),
    Column("rounds", "number"),
    Column("stratum", "number", spare=1),
    Column("rules", "number", spare=1),
)
_COVERAGE: Final = (Column("rule", "name"), Column("parts", "number"), Column("covered", "number"), Column("never"))

Cluster = Annotated[bool, typer.Option("--cluster", help="For a graph divided by source; the only plan so far.")]
Form = Annotated[str | None, typer.Option("--format", metavar="FORMAT", help=f"One of {', '.join(_FORMATS)}.")]


@with_settings("rules", "rule_families")
def graph(
    chosen: Chosen = None,
    *,
    settings: Settings,
    output: OutputFile = None,
    form: Form = None,
    json: Json = False,
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
