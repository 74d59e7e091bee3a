"""`kg corpus`: which repositories to take (`select`), and their files (`fetch`)."""

import sys
from collections import Counter
from collections.abc import Iterator, Sequence
from contextlib import AbstractContextManager, nullcontext
from dataclasses import asdict
from pathlib import Path
from typing import Annotated, Any, Final

import typer

from kg.cli.diagnostics import note, problem, say
from kg.cli.options import Json, argument, option, size, whole
from kg.cli.output import Column, json_lines, listing, numbers, save, terminal, write
from kg.cli.progress import ProgressBar
from kg.corpus.fetching.lock import FETCHED
from kg.corpus.selection.select import STATISTICS
from kg.errors import Exit, UsageError
from kg.lazily import lazily
from kg.render.text import count, printable

with lazily():
    from kg.corpus.fetching.git import Limits
    from kg.corpus.fetching.lock import Entry, Lock, Standing
    from kg.corpus.fetching.many import Fetched, pinned
    from kg.corpus.fetching.many import fetch as fetch_all
    from kg.corpus.fetching.one import Options
    from kg.corpus.fetching.wanted import read_wanted, wanted_among
    from kg.corpus.selection.criteria import default_criteria, read_criteria
    from kg.corpus.selection.data import read_dataset
    from kg.corpus.selection.select import Selection, paper_figures
    from kg.corpus.selection.select import select as selected_by


STEP_COLUMNS: Final = (Column("criterion", "name"), *numbers("removes", "left"), Column("which are", "dim", spare=1))
_HEADS: Final = {"median": "median", "mean": "mean", "sd": "SD", "cv": "CV"}
FIGURE_COLUMNS: Final = (
    Column("figure", "name"),
    Column("of"),
    *(Column(_HEADS.get(name, name), "number") for name in STATISTICS),
)
"""The columns of Table 2."""


def step_rows(selection: "Selection") -> "Iterator[tuple[object, ...]]":
    """Yield what each criterion removed, below the number of all projects."""
    yield "all", "", len(selection.dataset.projects), ""
    for step in selection.steps:
        yield step.criterion.name, len(step.removed), step.left, step.criterion.says


def figure_rows(selection: "Selection") -> "Iterator[tuple[object, ...]]":
    """Yield the rows of Table 2: our figure, the paper's, and the difference in percent."""
    paper = paper_figures()
    for key, ours in selection.figures.items():
        name, theirs = key.replace("_", " "), paper.table.get(key, {})
        yield name, "ours", *(_figure(ours.get(one), one) for one in STATISTICS)
        if theirs:
            yield name, "RNKG", *(_figure(theirs.get(one), one) for one in STATISTICS)
            yield name, "more", *(_more(ours.get(one), theirs.get(one)) for one in STATISTICS)


def _figure(value: float | None, statistic: str) -> str:
    if value is None:
        return "-"
    return f"{value:.2f}" if statistic in {"mean", "sd", "cv"} else f"{value:g}"


def _more(ours: float | None, paper: float | None) -> str:
    return f"{(ours / paper - 1) * 100:+.1f} %" if ours is not None and paper else "-"


def selection_object(selection: "Selection") -> dict[str, Any]:
    """Return a selection as plain values for JSON."""
    paper = paper_figures()
    return {
        "dataset": str(selection.dataset.path),
        "criteria": str(selection.criteria.path),
        "projects": len(selection.dataset.projects),
        "selected": len(selection.selected),
        "selected_paper": paper.projects,
        "steps": [
            {
                "criterion": step.criterion.name,
                "says": step.criterion.says,
                "removed": len(step.removed),
                "left": step.left,
                "projects": [project.cells[selection.criteria.project] for project in step.removed],
            }
            for step in selection.steps
        ],
        "figures": {
            name: {"ours": ours, "paper": dict(paper.table.get(name, {}))} for name, ours in selection.figures.items()
        },
        "addresses": list(selection.addresses()),
    }


_MOST_JOBS: Final = 64  # no server is asked for more at a time

Table = Annotated[str, argument("DATASET.csv", "A table of projects, as CSV.")]
CriteriaFile = Annotated[str | None, option("--criteria -c FILE", "Criteria, as TOML; by default those of kg.")]
Output = Annotated[str | None, option("--output -o LIST", "Write the addresses to this file, one per line.")]

Repositories = Annotated[
    str | None,
    argument(
        "LIST|DATASET.csv",
        "Addresses, one per line (URL or URL@REF), or a table to select from; by default those of the lock file.",
    ),
]
Into = Annotated[str | None, option("--into FOLDER", "Folder for checkouts; by default the folder of the lock file.")]
LockFile = Annotated[str | None, option("--lock FILE", "Lock file; by default corpus.lock.toml in the folder.")]
Version = Annotated[str | None, option("--ros 1|2|any", "ROS version whose branch is fetched; by default any.")]
Jobs = Annotated[str | None, option("--jobs -j N", "Number of parallel fetches; by default 4.")]
MaxSize = Annotated[str | None, option("--max-size SIZE", "Maximum size of a repository on disk; by default 500M.")]
Retries = Annotated[str | None, option("--retries N", "Number of retries after temporary errors; by default 3.")]
Seconds = Annotated[str | None, option("--timeout SECONDS", "Time limit per repository; by default 600.")]
Submodules = Annotated[bool, option("--submodules", "Also fetch submodules.")]
Update = Annotated[bool, option("--update", "Fetch the newest commits, not those of the lock file.")]


def select(table: Table, *, criteria: CriteriaFile = None, output: Output = None, json: Json = False) -> None:
    """Select projects from a table by criteria, and compare with RNKG's.

    Prints how many projects each criterion removes, in order, and the figures of the remaining projects next to those
    of the paper's Table 2. `kg corpus fetch` and `kg build` read the list of addresses. For example:

        kg corpus select repos_dataset_all.csv --output robots.txt
        kg corpus fetch robots.txt --into robots
    """
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
    with for_this_stream() as progress:
        done = fetch_all(wanted, folder, file, options, progress)
    summary(done)
    if json:
        json_lines(map(entry_object, done.entries))
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


_CODES: Final = {"refused": "KG134", "too large": "KG135", "too slow": "KG135", "in the way": "KG137"}
_LONGEST_NAME: Final = 40


def code_of(entry: "Entry") -> str | None:
    """Return the code of the error that prevented fetching a repository; None on success."""
    return None if entry.state == FETCHED else _CODES.get(entry.state, "KG133")


class Lines:
    """One line for each repository."""

    def __init__(self) -> None:
        self._all = 0
        self._done = 0

    def begin(self, repositories: int) -> None:
        """Write the number of repositories."""
        self._all = repositories
        say(f"fetching {count(repositories, 'repository', 'repositories')}")

    def ended(self, entry: "Entry") -> None:
        """Write the result of one repository."""
        self._done += 1
        where = f" {entry.branch} {entry.commit[:12]}".rstrip() if entry.state == FETCHED else ""
        say(f"{self._done}/{self._all} {printable(entry.name)}: {entry.state}{printable(where)}")


class Bar(ProgressBar):
    """A progress bar of repositories, with the last finished one."""

    def __init__(self) -> None:
        super().__init__("fetching", _LONGEST_NAME, threaded=True)

    def ended(self, entry: "Entry") -> None:
        """Advance the bar."""
        self.show(entry.name[-_LONGEST_NAME:], advance=1)


def for_this_stream() -> "AbstractContextManager[Bar | Lines]":
    """Return the display that suits standard error."""
    return Bar() if sys.stderr.isatty() else nullcontext(Lines())


def summary(done: "Fetched") -> None:
    """Report repositories that were not fetched with reasons, changed commits, and totals."""
    for entry in sorted(done.entries, key=lambda one: one.name):
        if failed(entry):
            continue
        if entry.moved:
            note(f"{printable(entry.name)} moved to {printable(entry.moved)}")
        elif entry.reason:
            note(f"{printable(entry.name)}: {printable(entry.reason)}")
    states = Counter(entry.state for entry in done.entries)
    size = sum(entry.bytes for entry in done.entries if entry.state == FETCHED)
    others = "".join(f", {number:,} {state}" for state, number in sorted(states.items()) if state != FETCHED)
    fetched = count(states[FETCHED], "repository", "repositories")
    say(f"{fetched} fetched ({size / 1e6:,.1f} MB){others}; {printable(str(done.lock.path))} pins them")


def failed(entry: "Entry") -> bool:
    """Return whether a repository was not fetched, and report the reason."""
    code = code_of(entry)
    if code:
        problem(code, f"{entry.state}: {entry.reason}", entry.name)
    return code is not None


def report_unfetched(entries: "Sequence[Entry]") -> bool:
    """Report the repositories that workers of a cluster could not fetch; return whether there are any."""
    for entry in sorted(entries, key=lambda one: one.name):
        failed(entry)
    if entries:
        note(f"{count(len(entries), 'repository', 'repositories')} left out; build again to try again")
    return bool(entries)


def not_as_pinned(lock: "Lock", state: "Standing") -> None:
    """Report the repositories of a lock file that are missing or differ from it."""
    place = printable(str(lock.path))
    for entry in state.missing:
        why = "was not fetched" if entry.state == FETCHED else f"{entry.state}: {entry.reason}"
        problem("KG136", why, entry.name)
    for entry, difference in state.drifted:
        problem("KG137", difference, entry.name)
    if state.missing:
        missing = count(len(state.missing), "repository", "repositories")
        note(f"{missing} of {place} not checked out; fetch them with `kg corpus fetch --lock {place}`")
    if state.drifted:
        note(f"{count(len(state.drifted), 'checkout')} not at the commits that {place} pins; building them as they are")


def entry_object(entry: "Entry") -> dict[str, Any]:
    """Return an entry as plain values for JSON, with its code."""
    return {**asdict(entry), "code": code_of(entry)}
