"""`kg eval`: how complete and how right the graph is, and how well nodes are found, as RNKG evaluates it; exercises."""

from pathlib import Path
from typing import Annotated

import typer

from kg.cli.diagnostics import note, say
from kg.cli.options import Json, argument, option, require_one_of, whole, with_settings
from kg.cli.output import Column, listing, write_text
from kg.errors import Exit, UsageError
from kg.lazily import lazily
from kg.render.text import count
from kg.settings import Settings
from kg.store.opening import existing, reading

with lazily():
    import asyncio

    from kg.evaluate.code_check import check_code
    from kg.evaluate.exercises import (
        capabilities_of_robots,
        capabilities_table,
        exercises_table,
        perform_all,
        read,
        runs_table,
        table,
    )
    from kg.evaluate.linking import Ground
    from kg.evaluate.linking import forget as drop
    from kg.evaluate.linking import keep as add
    from kg.evaluate.references import Choice
    from kg.evaluate.retrieval import read_needs, retrieval
    from kg.evaluate.sheet import Facts, SourceLines, as_sheet, drawn, score_sheet
    from kg.evaluate.tables import Table, as_csv, as_objects, spelled, write
    from kg.graph.source_states import sources
    from kg.search.searching import open_search


References = Annotated[
    list[str] | None, option("--reference -r FILE", "References: JSON lines, a wiki page, a README, a folder of pages.")
]
Closed = Annotated[bool, option("--closed", "Assume that references are complete.")]
AnyCommit = Annotated[bool, option("--any-commit", "Also compare references of other commits.")]
Package = Annotated[str | None, option("--package -p NAME", "Package that wiki pages and READMEs describe.")]
Seed = Annotated[str, option("--seed N", "Seed of the random sample.")]
Code = Annotated[bool, option("--code", "Compare with the code instead of references.")]
SampleSize = Annotated[str, option("--sample N", "With --code: number of calls, and of facts, to sample.")]
Tests = Annotated[bool, option("--tests", "With --code: also search test files.")]
Missed = Annotated[str | None, option("--missed FILE", "With --code: write the failures, as CSV.")]
Keep = Annotated[bool, option("--keep", "Keep the references in the store, for the stored queries.")]
Forget = Annotated[bool, option("--forget", "Remove kept references from the store.")]
Size = Annotated[str, option("--size -n N", "Number of facts to draw.")]
Relations = Annotated[list[str] | None, option("--relation NAME", "Only this relation; may be repeated.")]
Sheet = Annotated[str | None, option("--output -o FILE", "Write the sheet to FILE.")]
Judged = Annotated[str | None, option("--score FILE", "Score a judged sheet.")]
Tables = Annotated[str | None, option("--tables FOLDER", "Write the scores as Markdown, CSV and SVG.")]
Needs = Annotated[str, option("--queries -q FILE", "Needs with judged nodes: JSON lines.")]
Model = Annotated[str | None, option("--model FOLDER", "Model of sentence embeddings to include in the comparison.")]
Output = Annotated[str | None, option("--output -o FOLDER", "Write Markdown, CSV and SVG into FOLDER.")]


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
    from kg.evaluate.sheet import RELATIONS  # noqa: PLC0415 - start-up time

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
    *, settings: Settings, queries: Needs, model: Model = None, output: Output = None, json: Json = False
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
        hint = "Add --reference FILE for each reference. `kg eval completeness --code` needs none."
        raise UsageError("KG003", "no references given", hint=hint)
    return [Path(one).expanduser() for one in reference]


def _keep(settings: Settings, ground: "Ground") -> None:
    add(settings, ground.triples)
    say(f"kept {count(len(ground.linked), 'reference')} in the store")


Capabilities = Annotated[
    bool, option("--capabilities", "Print Table 1: the inferred capabilities of each simulated robot.")
]
Run = Annotated[bool, option("--run", "Run the exercises and report which reach their goal.")]
Results = Annotated[list[str], argument("RESULTS", "Results of a study (CSV), as the page saves them.")]


@with_settings("store")
def exercises(
    *,
    settings: Settings,
    capabilities: Capabilities = False,
    run: Run = False,
    output: Output = None,
    json: Json = False,
) -> None:
    """Compare capability programs with equivalent code in four exercises.

    Compares blocks and capabilities of the program with lines, components and message types of the code, for two
    simulated robots, as in Table 2 of the onto-ros paper. The programs are in examples/programs. Needs the extra
    `simulate`. For example:

        kg eval exercises
        kg eval exercises --capabilities
        kg eval exercises --run
    """
    if run:
        outcomes = asyncio.run(perform_all(settings))
        deliver(runs_table(outcomes), json=json, output=output)
        if any(one.missed for one in outcomes):
            raise typer.Exit(Exit.FOUND)
        return
    results = asyncio.run(capabilities_of_robots(settings))
    deliver(capabilities_table(results) if capabilities else exercises_table(results), json=json, output=output)


def study(files: Results, *, json: Json = False, output: Output = None) -> None:
    """Evaluate the results of a study: time, attempts, blocks and capabilities of each exercise.

    Takes the files that the robot page saves (Examples, Study with four tasks), and prints them next to the figures of
    Table 2 of the onto-ros paper. For example:

        kg eval study alice.csv bob.csv
        kg eval study *.csv --output report
    """
    deliver(table([row for file in files for row in read(file)]), json=json, output=output)
