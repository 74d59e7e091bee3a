"""The two sides that `kg diff` compares: what was asked for, and all that is known of each."""

from __future__ import annotations

from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING

from kg.errors import UsageError

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from kg.cli.links import Links
    from kg.graph.source_states import SourceState
    from kg.graph.systems_reading import SystemName
    from kg.launch.comparison import Side, Sources
    from kg.settings import Settings
    from kg.store.embedded import EmbeddedStore


@dataclass(frozen=True, slots=True)
class Sides:
    """What was asked for: two stores, or two commits of `repository`; `since` for three dots."""

    before: str
    after: str
    repository: Path | None = None
    since: bool = False

    @property
    def title(self) -> str:
        """The words that stand for both."""
        if self.repository is None:
            return f"{self.before} and {self.after}"
        return f"{self.before}{'...' if self.since else '..'}{self.after}"


@dataclass(frozen=True, slots=True)
class Known:
    """One side, read: what is compared, the states of its sources by name, and the names of all its launch files."""

    sources: Sources
    states: Mapping[str, SourceState]
    launches: Sequence[SystemName]


def sides(named: Sequence[str], repository: str | None) -> Sides:
    """Return what the arguments mean: `A..B`, `A...B`, `A B`; two folders are stores. KG003 for anything else."""
    folder = Path(repository or ".")
    if len(named) == 1 and ".." in named[0]:
        dots = "..." if "..." in named[0] else ".."
        before, _, after = named[0].partition(dots)
        return Sides(before or "HEAD", after or "HEAD", folder, since=dots == "...")
    if len(named) == 2:  # noqa: PLR2004 - a before and an after
        if repository is None and all(Path(name).is_dir() for name in named):
            return Sides(named[0], named[1])
        return Sides(named[0], named[1], folder)
    hint = (
        f"`kg diff {named[0]}..HEAD` compares it with the last commit."
        if named
        else "For example: `kg diff main..HEAD`."
    )
    raise UsageError("KG003", "two commits or two stores are compared", hint=hint)


def stores(asked: Sides, settings: Settings) -> tuple[EmbeddedStore, EmbeddedStore]:
    """Return both stores; commits that were not read before are read now. Raises as `kg.pipeline.revisions` does."""
    from kg.cli.progress import for_people  # noqa: PLC0415 - start-up time
    from kg.pipeline.revisions import merge_base, resolve, revision_store  # noqa: PLC0415 - start-up time
    from kg.store.opening import existing  # noqa: PLC0415 - start-up time

    if asked.repository is None:
        first, second = (existing(replace(settings, store=Path(name))) for name in (asked.before, asked.after))
        return first, second
    before, after = resolve(asked.repository, asked.before), resolve(asked.repository, asked.after)
    if asked.since:
        before = merge_base(asked.repository, before, after)
    found = []
    for revision in (before, after):
        with for_people() as progress:
            found.append(revision_store(asked.repository, revision, settings, progress))
    return found[0], found[1]


def known(store: EmbeddedStore, settings: Settings, launch: str | None) -> Known:
    """Return what is known of a side; with `launch` only of the launch files that it may mean."""
    from kg.graph.reading import node_records  # noqa: PLC0415 - start-up time
    from kg.graph.source_states import sources  # noqa: PLC0415 - start-up time
    from kg.graph.systems_reading import system_names, systems  # noqa: PLC0415 - start-up time
    from kg.launch.comparison import Sources  # noqa: PLC0415 - start-up time
    from kg.lint.reading import read_findings  # noqa: PLC0415 - start-up time
    from kg.pipeline.launch_names import matching  # noqa: PLC0415 - start-up time
    from kg.views.impact_changes import compared_finding  # noqa: PLC0415 - start-up time

    with store.read() as snapshot:
        every = system_names(snapshot)
        names = every if launch is None else matching(every, launch)
        chosen = {one.name for one in names}
        findings = [compared_finding(one) for one in read_findings(snapshot, settings.base) if one.system in chosen]
        nodes = node_records(snapshot) if launch is None else []
        found = Sources(nodes, systems(snapshot, names, settings.base), findings)
        return Known(found, {one.name: one for one in sources(snapshot)}, every)


def address(links: tuple[Links, Links], side: Side, *, is_after: bool) -> str | None:
    """Return the address of the page of a side's line; None where its source is no commit of a forge."""
    if side.location is None or not side.repository:
        return None
    found = links[is_after].to(side.repository, side.location)
    return found if found and found.startswith("https://") else None
