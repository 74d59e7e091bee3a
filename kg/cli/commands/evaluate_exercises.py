"""`kg eval exercises`: programs next to equivalent code, and whether they reach their goals."""

from typing import Annotated

import typer

from kg.cli.commands.evaluate import Output, deliver
from kg.cli.options import Json, with_settings
from kg.errors import Exit
from kg.lazily import lazily
from kg.settings import Settings

with lazily():
    import asyncio

    from kg.evaluate.exercise_tables import capabilities_of_robots, capabilities_table, exercises_table, runs_table
    from kg.evaluate.exercises import perform_all
    from kg.evaluate.study import read, table

Capabilities = Annotated[
    bool, typer.Option("--capabilities", help="Print Table 1: the inferred capabilities of each simulated robot.")
]
Run = Annotated[bool, typer.Option("--run", help="Run the exercises and report which reach their goal.")]
Results = Annotated[
    list[str], typer.Argument(metavar="RESULTS", help="Results of a study (CSV), as the page saves them.")
]


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


def study(
    files: Results,
    *,
    json: Json = False,
    output: Output = None,
) -> None:
    """Evaluate the results of a study: time, attempts, blocks and capabilities of each exercise.

    Takes the files that the robot page saves (Examples, Study with four tasks), and prints them next to the figures of
    Table 2 of the onto-ros paper. For example:

        kg eval study alice.csv bob.csv
        kg eval study *.csv --output report
    """
    deliver(table([row for file in files for row in read(file)]), json=json, output=output)
