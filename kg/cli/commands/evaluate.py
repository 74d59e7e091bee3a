"""`kg eval`: how complete and how right the graph is, and how well nodes are found, as RNKG evaluates it."""

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from kg.cli.diagnostics import note, say
from kg.cli.numbers import whole
from kg.cli.options import Json, require_one_of, with_settings
from kg.cli.output import Column, listing, write_text
from kg.errors import UsageError
from kg.lazily import lazily
from kg.render.text import count
from kg.settings import Settings
from kg.store.opening import existing, reading

if TYPE_CHECKING:
    from kg.evaluate.linking import Ground

with lazily():
    from kg.evaluate.code_check import check_code
    from kg.evaluate.facts import Facts
    from kg.evaluate.gathering import Choice
    from kg.evaluate.judged_needs import read_needs
    from kg.evaluate.keeping import forget as drop
    from kg.evaluate.keeping import keep as add
    from kg.evaluate.retrieval import retrieval
    from kg.evaluate.sheet import as_sheet, drawn, score_sheet
    from kg.evaluate.source_lines import SourceLines
    from kg.evaluate.tables import Table, as_csv, as_objects, spelled
    from kg.evaluate.writing import write
    from kg.graph.source_states import sources
    from kg.search.searching import open_search

References = Annotated[
    list[str] | None,
    typer.Option(
        "--reference", "-r", metavar="FILE", help="References: JSON lines, a wiki page, a README, a folder of pages."
    ),
]
Closed = Annotated[bool, typer.Option("--closed", help="Assume that references are complete.")]
AnyCommit = Annotated[bool, typer.Option("--any-commit", help="Also compare references of other commits.")]
Package = Annotated[
    str | None, typer.Option("--package", "-p", metavar="NAME", help="Package that wiki pages and READMEs describe.")
]
Seed = Annotated[str, typer.Option("--seed", metavar="N", help="Seed of the random sample.")]
Code = Annotated[bool, typer.Option("--code", help="Compare with the code instead of references.")]
SampleSize = Annotated[
    str, typer.Option("--sample", metavar="N", help="With --code: number of calls, and of facts, to sample.")
]
Tests = Annotated[bool, typer.Option("--tests", help="With --code: also search test files.")]
Missed = Annotated[
    str | None, typer.Option("--missed", metavar="FILE", help="With --code: write the failures, as CSV.")
]
Keep = Annotated[bool, typer.Option("--keep", help="Keep the references in the store, for the stored queries.")]
Forget = Annotated[bool, typer.Option("--forget", help="Remove kept references from the store.")]
Size = Annotated[str, typer.Option("--size", "-n", metavar="N", help="Number of facts to draw.")]
Relations = Annotated[
    list[str] | None, typer.Option("--relation", metavar="NAME", help="Only this relation; may be repeated.")
]
Sheet = Annotated[str | None, typer.Option("--output", "-o", metavar="FILE", help="Write the sheet to FILE.")]
Judged = Annotated[str | None, typer.Option("--score", metavar="FILE", help="Score a judged sheet.")]
Tables = Annotated[
    str | None, typer.Option("--tables", metavar="FOLDER", help="Write the scores as Markdown, CSV and SVG.")
]
Needs = Annotated[str, typer.Option("--queries", "-q", metavar="FILE", help="Needs with judged nodes: JSON lines.")]
Model = Annotated[
    str | None,
    typer.Option("--model", metavar="FOLDER", help="Model of sentence embeddings to include in the comparison."),
]
Output = Annotated[
    str | None, typer.Option("--output", "-o", metavar="FOLDER", help="Write Markdown, CSV and SVG into FOLDER.")
]


@with_settings("store")
def completeness(  # noqa: PLR0913 - the options of a command
    *,
    settings: Settings,
    reference: References = None,
    code: Code = False,
    number: SampleSize = "300",
    seed: Seed = "0",
    tests: Tests = False,
    missed: Missed = None,
    package: Package = None,
    any_commit: AnyCommit = False,
    keep: Keep = False,
    forget: Forget = False,
    output: Output = None,
    json: Json = False,
) -> None:
    """Measure how much of references or code the graph contains.

    Covers nodes, topics, services, actions, types and parameters, as in RNKG's Table 8, with Wilson intervals. A name
    is found if its package has an endpoint or parameter of that name and role. With --code, the graph is compared with
    the code (Table 9): sampled calls found by a simpler, independent reader, and sampled facts with their lines. For
    example:

        kg eval completeness --reference nodes.jsonl
        kg eval completeness -r src/scan_tools/README.md -r src/nav/doc/wiki.txt --output tables
        kg eval completeness --code --sample 500 --missed missed.csv
    """
    if code:
        size, chance = whole(number, "--sample", 1), whole(seed, "--seed", 0)
        _code(settings, size, chance, tests=tests, missed=missed, output=output, json=json)
    elif forget:
        say("forgot the references" if drop(settings) else "no references were kept")
    else:
        from kg.evaluate.completeness import completeness as measure  # noqa: PLC0415 - start-up time

        with reading(settings) as snapshot:
            table, ground = measure(snapshot, _paths(reference), Choice(False, any_commit, package))
        deliver(table, json=json, output=output)
        if keep:
            _keep(settings, ground)


def _code(  # noqa: PLR0913 - the options of a command
    settings: Settings, size: int, seed: int, *, tests: bool, missed: str | None, output: str | None, json: bool
) -> None:
    with reading(settings) as snapshot:
        checked = check_code(snapshot, SourceLines(sources(snapshot)), size, seed, tests=tests)
    deliver(checked.table, json=json, output=output)
    if missed:
        rows = tuple((one.measure, one.kind, one.address, one.text) for one in checked.missed)
        write_text(as_csv(Table("missed", "Missed", ("measure", "kind", "address", "source"), rows)), missed)
        say(f"{count(len(checked.missed), 'miss', 'misses')} in {missed}")


@with_settings("store")
def correctness(  # noqa: PLR0913 - the options of a command
    *,
    settings: Settings,
    reference: References = None,
    closed: Closed = False,
    package: Package = None,
    any_commit: AnyCommit = False,
    keep: Keep = False,
    output: Output = None,
    json: Json = False,
) -> None:
    """Compare the relations of nodes with references: precision, recall and F1.

    Results are by relation, as in RNKG's Table 10. Precision needs references that list everything that a node has.
    Files declare this by role (`closed_world`); --closed declares it for all. For example:

        kg eval correctness --reference truth.jsonl
        kg eval correctness -r truth.jsonl --closed --json
    """
    from kg.evaluate.completeness import correctness as measure  # noqa: PLC0415 - start-up time

    choice = Choice(closed, any_commit, package)
    with reading(settings) as snapshot:
        table, ground = measure(snapshot, _paths(reference), choice)
    deliver(table, json=json, output=output)
    if keep:
        _keep(settings, ground)


@with_settings("store")
def sample(  # noqa: PLR0913 - the options of a command
    *,
    settings: Settings,
    size: Size = "100",
    seed: Seed = "0",
    relation: Relations = None,
    output: Sheet = None,
    score: Judged = None,
    tables: Tables = None,
    json: Json = False,
) -> None:
    """Draw facts to be judged by a person, or score a judged sheet.

    The sheet (CSV) contains equally many facts of each relation, inferred ones included, each with its line of code.
    Enter yes, no or unsure in its column `right`. The score is the precision by relation, with Wilson intervals. For
    example:

        kg eval sample --size 100 --output sheet.csv
        kg eval sample --score sheet.csv
    """
    if score:
        deliver(score_sheet(Path(score).expanduser()), json=json, output=tables)
        return
    from kg.evaluate.facts import RELATIONS  # noqa: PLC0415 - start-up time

    number, chance = whole(size, "--size", 1), whole(seed, "--seed", 0)
    for name in relation or ():
        require_one_of(name, RELATIONS, "relation")
    with reading(settings) as snapshot:
        facts = Facts(snapshot)
        sampled = drawn(facts, relation or list(RELATIONS), number, chance)
        text = as_sheet(facts, sampled, SourceLines(sources(snapshot)))
    write_text(text, output)
    say(f"{count(len(sampled), 'fact')} to judge")


@with_settings("store")
def search(
    *,
    settings: Settings,
    queries: Needs,
    model: Model = None,
    output: Output = None,
    json: Json = False,
) -> None:
    """Compare the search with other methods: NDCG@1 and NDCG@5.

    The methods are those of RNKG's Table 11: TF-IDF, fuzzy names, subgraph matching of the interfaces that a need
    names, and sentence embeddings if a model is given. Results have bootstrap intervals. For example:

        kg eval search --queries needs.jsonl
        kg eval search --queries needs.jsonl --model ~/models/all-MiniLM-L6-v2 --output tables
    """
    needs = read_needs(Path(queries).expanduser())
    index = open_search(existing(settings))
    table = retrieval(index, needs, Path(model).expanduser() if model else None)
    deliver(table, json=json, output=output)


def deliver(table: "Table", *, json: bool, output: str | None) -> None:
    """Print a table (as JSON Lines with `json`), its notes to standard error, and write the requested files."""
    numeric = {name for at, name in enumerate(table.columns) if not any(isinstance(row[at], str) for row in table.rows)}
    columns = [Column(name, "number" if name in numeric else "text") for name in table.columns]
    rows = [[spelled(cell) for cell in row] for row in table.rows]
    listing(columns, rows, objects=as_objects(table) if json else None)
    for sentence in table.notes:
        note(sentence)
    if output:
        written = write(table, Path(output).expanduser())
        say(f"wrote {', '.join(path.name for path in written)} to {output}")


def _paths(reference: list[str] | None) -> list[Path]:
    if not reference:
        raise UsageError("KG003", "no references given", hint="Add --reference FILE for each reference.")
    return [Path(one).expanduser() for one in reference]


def _keep(settings: Settings, ground: "Ground") -> None:
    add(settings, ground.triples)
    say(f"kept {count(len(ground.linked), 'reference')} in the store")
