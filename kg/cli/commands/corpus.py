"""`kg corpus`: which repositories to take (`select`), and their files (`fetch`)."""

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Final

import typer

from kg.cli.diagnostics import note
from kg.cli.numbers import size, whole
from kg.cli.options import Json
from kg.cli.output import json_lines, listing, save, terminal, write
from kg.errors import Exit, UsageError
from kg.lazily import lazily
from kg.render.text import count

if TYPE_CHECKING:
    from kg.corpus.selection.select import Selection

with lazily():
    from kg.cli import fetching_view
    from kg.cli.corpus_view import figure_rows, selection_object, step_rows
    from kg.corpus.fetching.git import Limits
    from kg.corpus.fetching.many import fetch as fetch_all
    from kg.corpus.fetching.many import pinned
    from kg.corpus.fetching.one import Options
    from kg.corpus.fetching.wanted import read_wanted, wanted_among
    from kg.corpus.selection.criteria import default_criteria, read_criteria
    from kg.corpus.selection.data import read_dataset
    from kg.corpus.selection.select import paper_figures
    from kg.corpus.selection.select import select as selected_by

_MOST_JOBS: Final = 64  # no server is asked for more at a time

Table = Annotated[str, typer.Argument(metavar="DATASET.csv", help="A table of projects, as CSV.")]
CriteriaFile = Annotated[
    str | None,
    typer.Option("--criteria", "-c", metavar="FILE", help="Criteria, as TOML; by default those of kg."),
]
Output = Annotated[
    str | None, typer.Option("--output", "-o", metavar="LIST", help="Write the addresses to this file, one per line.")
]

Repositories = Annotated[
    str | None,
    typer.Argument(
        metavar="LIST|DATASET.csv",
        help="Addresses, one per line (URL or URL@REF), or a table to select from; by default those of the lock file.",
    ),
]
Into = Annotated[
    str | None,
    typer.Option("--into", metavar="FOLDER", help="Folder for checkouts; by default the folder of the lock file."),
]
LockFile = Annotated[
    str | None,
    typer.Option("--lock", metavar="FILE", help="Lock file; by default corpus.lock.toml in the folder."),
]
Version = Annotated[
    str | None, typer.Option("--ros", metavar="1|2|any", help="ROS version whose branch is fetched; by default any.")
]
Jobs = Annotated[
    str | None, typer.Option("--jobs", "-j", metavar="N", help="Number of parallel fetches; by default 4.")
]
MaxSize = Annotated[
    str | None,
    typer.Option("--max-size", metavar="SIZE", help="Maximum size of a repository on disk; by default 500M."),
]
Retries = Annotated[
    str | None, typer.Option("--retries", metavar="N", help="Number of retries after temporary errors; by default 3.")
]
Seconds = Annotated[
    str | None, typer.Option("--timeout", metavar="SECONDS", help="Time limit per repository; by default 600.")
]
Submodules = Annotated[bool, typer.Option("--submodules", help="Also fetch submodules.")]
Update = Annotated[bool, typer.Option("--update", help="Fetch the newest commits, not those of the lock file.")]


def select(
    table: Table,
    *,
    criteria: CriteriaFile = None,
    output: Output = None,
    json: Json = False,
) -> None:
    """Select projects from a table by criteria, and compare with RNKG's.

    Prints how many projects each criterion removes, in order, and the figures of the remaining projects next to those
    of the paper's Table 2. `kg corpus fetch` and `kg build` read the list of addresses. For example:

        kg corpus select repos_dataset_all.csv --output robots.txt
        kg corpus fetch robots.txt --into robots
    """
    from kg.cli.corpus_view import FIGURE_COLUMNS, STEP_COLUMNS  # noqa: PLC0415 - start-up time

    chosen = _selected(table, criteria)
    if json:
        json_lines([selection_object(chosen)])
    else:
        listing(STEP_COLUMNS, step_rows(chosen))
        write()
        listing(FIGURE_COLUMNS, figure_rows(chosen))
        if terminal():
            note(f"{count(len(chosen.selected), 'project')} selected; RNKG has {paper_figures().projects}")
    if output:
        title = (
            f"# {count(len(chosen.selected), 'project')} of {chosen.dataset.path.name}, by {chosen.criteria.path.name}"
        )
        save(output, "\n".join([title, *chosen.addresses(), ""]).encode())


def _selected(table: str, criteria: str | None) -> "Selection":
    chosen = read_criteria(Path(criteria).expanduser() if criteria else default_criteria())
    return selected_by(read_dataset(Path(table).expanduser()), chosen)


def fetch(  # noqa: PLR0913 - the options of a command
    repositories: Repositories = None,
    *,
    into: Into = None,
    lock: LockFile = None,
    criteria: CriteriaFile = None,
    ros: Version = None,
    jobs: Jobs = None,
    max_size: MaxSize = None,
    retries: Retries = None,
    timeout: Seconds = None,
    submodules: Submodules = False,
    update: Update = False,
    json: Json = False,
) -> None:
    """Fetch repositories, each at one commit, and pin the commits in a lock file.

    Only the files of that commit are fetched, without history. Nothing from a repository is run. Missing, oversized,
    slow or harmful repositories are reported and the others fetched. Run the command again to continue. With a lock
    file, the commits in it are fetched. For example:

        kg corpus fetch robots.txt --into robots
        kg corpus fetch --lock robots/corpus.lock.toml
        kg build --corpus robots/corpus.lock.toml
    """
    if into is None and lock is None:
        raise UsageError("KG003", "no folder or lock file given", hint="Give --into FOLDER or --lock FILE.")
    # The place of each follows from the other.
    folder = Path(into).expanduser() if into else Path(str(lock)).expanduser().absolute().parent
    file = Path(lock).expanduser() if lock else folder / "corpus.lock.toml"
    if repositories is None:
        wanted = pinned(file)
    elif repositories.lower().endswith(".csv"):
        wanted = wanted_among(_selected(repositories, criteria).addresses())
    else:
        wanted = read_wanted(Path(repositories).expanduser())
    options = _options(ros, jobs, max_size, retries, timeout, submodules=submodules, update=update)
    with fetching_view.for_this_stream() as progress:
        done = fetch_all(wanted, folder, file, options, progress)
    fetching_view.summary(done)
    if json:
        json_lines(map(fetching_view.entry_object, done.entries))
    if done.failed:
        raise typer.Exit(Exit.FOUND)


def _options(  # noqa: PLR0913 - the options of a command
    ros: str | None,
    jobs: str | None,
    max_size: str | None,
    retries: str | None,
    timeout: str | None,
    *,
    submodules: bool,
    update: bool,
) -> "Options":
    from kg.corpus.fetching.one import VERSIONS  # noqa: PLC0415 - start-up time

    if ros is not None and ros not in VERSIONS:
        raise UsageError("KG003", f"`--ros {ros}` is not a version of ROS", hint="Write --ros 1, --ros 2 or --ros any.")
    usual, limits = Options(), Limits()
    return Options(
        ros=ros or usual.ros,
        jobs=whole(jobs, "--jobs", 1, _MOST_JOBS) if jobs else usual.jobs,
        submodules=submodules,
        update=update,
        limits=Limits(
            bytes=size(max_size, "--max-size") if max_size else limits.bytes,
            seconds=whole(timeout, "--timeout", 1) if timeout else limits.seconds,
            retries=whole(retries, "--retries", 0) if retries else limits.retries,
        ),
    )
