"""Progress of a build on standard error: a bar on a terminal, else one line per package."""

from __future__ import annotations

import sys
from contextlib import AbstractContextManager, contextmanager, nullcontext
from typing import TYPE_CHECKING, Final, Self

from kg.cli.diagnostics import say
from kg.lazily import lazily
from kg.pipeline.report import PackageResult, Report
from kg.render.text import count, printable

if TYPE_CHECKING:
    from collections.abc import Iterator

    from kg.facts import Problem, Repository

with lazily():
    from rich.console import Console
    from rich.progress import BarColumn, MofNCompleteColumn, Progress, SpinnerColumn, TextColumn, TimeElapsedColumn

_LONGEST_NAME: Final = 32


class Lines(Report):
    """One line per event, for logs and pipes."""

    def fetching(self, message: str) -> None:
        """Write the progress of fetching a git address."""
        say(printable(message))

    def source(self, repository: Repository, packages: int, problems: tuple[Problem, ...]) -> None:  # noqa: ARG002 - the end lists problems
        """Write the content of a source."""
        say(f"source {printable(repository.name)}: {count(packages, 'package')}")

    def planned(self, read: int, reused: int, jobs: int) -> None:
        """Write the plan."""
        if read:
            unchanged = f", {reused:,} unchanged" if reused else ""
            means = f"with {count(jobs, 'process', 'processes')}" if jobs else "on the cluster"
            say(f"reading {count(read, 'package')}{unchanged}, {means}")

    def placed(self, worker: str, source: str) -> None:
        """Write the work that a worker of a cluster starts."""
        say(f"{printable(worker)} reads {printable(source)}")

    def done(self, result: PackageResult) -> None:
        """Write the result of a package."""
        counts = (
            f"{count(result.counts.get('nodes', 0), 'node')}, {count(result.counts.get('interfaces', 0), 'interface')}"
        )
        problems = f", {count(len(result.problems), 'problem')}" if result.problems else ""
        say(f"read {printable(result.name)}: {counts}{problems} ({result.seconds:.2f} s)")

    def writing(self, triples: int) -> None:  # noqa: ARG002 - most of them may be in the store already
        """Write that the store is being written."""
        say("writing")

    def inferring(self) -> None:
        """Write that rules are running."""
        say("inferring")


class ProgressBar:
    """A bar on standard error, with the time spent and at most `width` characters about what was done last.

    Without `threaded` it is drawn only when something happens, never by a thread.
    """

    def __init__(self, task: str, width: int, *, threaded: bool) -> None:
        self._progress = Progress(
            TextColumn("{task.description}", markup=False),
            BarColumn(bar_width=None),
            MofNCompleteColumn(),
            TimeElapsedColumn(),
            console=Console(stderr=True, highlight=False),
            transient=True,
            auto_refresh=threaded,
        )
        self._task = self._progress.add_task(task, total=None)
        self._width = width

    def __enter__(self) -> Self:
        self._progress.start()
        return self

    def __exit__(self, *_: object) -> None:
        """Remove the bar; lines above it remain."""
        self._progress.stop()

    def show(self, text: str, *, advance: int = 0) -> None:
        """Show what is done, and let the bar grow by so many."""
        shown = printable(text)[: self._width]
        self._progress.update(self._task, description=f"{shown:<{self._width}}", advance=advance, refresh=True)

    def begin(self, total: int) -> None:
        """Set the length of the bar."""
        self._progress.update(self._task, total=total, completed=0)


class Bar(ProgressBar, Report):
    """A bar that grows by packages; no thread draws it, because the build forks its workers."""

    def __init__(self) -> None:
        super().__init__("looking for packages", _LONGEST_NAME, threaded=False)

    def fetching(self, message: str) -> None:
        """Show the progress of fetching a git address."""
        self.show(message)

    def planned(self, read: int, reused: int, jobs: int) -> None:  # noqa: ARG002 - the final summary has them
        """Set the length of the bar."""
        self.begin(read)
        self.show("reading")

    def placed(self, worker: str, source: str) -> None:
        """Show the work that a worker of a cluster starts."""
        self.show(f"{worker.rpartition('/')[2]} {source}")

    def done(self, result: PackageResult) -> None:
        """Advance the bar."""
        self.show(f"read {result.name}", advance=1)

    def writing(self, triples: int) -> None:  # noqa: ARG002 - most of them may be in the store already
        """Show that the store is being written."""
        self.show("writing")

    def inferring(self) -> None:
        """Show that rules are running."""
        self.show("inferring")


def for_this_stream() -> AbstractContextManager[Report]:
    """Return the display that suits standard error."""
    return Bar() if sys.stderr.isatty() else nullcontext(Lines())


def for_people() -> AbstractContextManager[Report]:
    """Return the display for commands that build as a side effect: a bar on a terminal, else nothing."""
    return Bar() if sys.stderr.isatty() else nullcontext(Report())


@contextmanager
def waiting(what: str) -> Iterator[None]:
    """Show elapsed time on a terminal during long work."""
    if not sys.stderr.isatty():
        yield
        return

    columns = (SpinnerColumn(), TextColumn("{task.description}", markup=False), TimeElapsedColumn())
    with Progress(*columns, console=Console(stderr=True, highlight=False), transient=True) as progress:
        progress.add_task(what, total=None)
        yield
