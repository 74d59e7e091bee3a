"""What a build would do, without doing it: the packages that it would read again, and its volume and time.

`pending` and `rules_changed` read, fetch and wait for nothing; `estimate` scans sources, but opens no source file.
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import TYPE_CHECKING, Final

from kg.corpus.sources import is_address
from kg.corpus.workspace import Workspace
from kg.errors import SourceError, StoreError
from kg.pipeline.inferring import last_run
from kg.pipeline.plan import code_bytes, make_plan, version
from kg.pipeline.reasoning import digest
from kg.pipeline.report import Report
from kg.pipeline.sources import gather, installed_folders
from kg.pipeline.state import State, load
from kg.store.layout import Layout
from kg.store.opening import layout_of

if TYPE_CHECKING:
    from collections.abc import Sequence

    from kg.corpus.files import PackageFolder, Source
    from kg.settings import Settings


def pending(layout: Layout, settings: Settings) -> dict[str, tuple[str, ...] | None]:
    """Return the packages that a build would read again, for each source of earlier builds.

    The value is None for a source that no longer exists. For git addresses, the last fetched state counts. Sources on
    other machines are left out.
    """
    state = load(layout.cache)
    named = [root for root in _roots(state, layout) if Path(root).exists()]
    changed: dict[str, tuple[str, ...] | None] = {
        name: None for name, source in state.sources.items() if not source.elsewhere
    }
    try:
        sources = gather(named, layout.checkouts, Report())
    except SourceError:
        return changed
    workspace = Workspace(sources, installed_folders(settings))
    plan = make_plan(workspace, state, layout.cache, version(settings, layout.cache), settings.max_file_bytes)
    for source in sources:
        name = source.repository.name
        changed[name] = tuple(package.name for one, package in plan.read if one.repository.name == name)
    return changed


def rules_changed(layout: Layout, settings: Settings) -> bool:
    """Return whether the enabled rules differ from those that ran last; False if none ran.

    Raises as `kg.pipeline.reasoning.digest`.
    """
    last = last_run(layout.cache)
    return last is not None and last.digest != digest(settings, layout.cache)


def _roots(state: State, layout: Layout) -> list[str]:
    """Return the folders that earlier builds read; for git addresses their clones."""
    clones = [one.repository.root for one in state.sources.values()]
    checkouts = str(layout.checkouts)
    return [root for root in state.roots if not is_address(root)] + [one for one in clones if one.startswith(checkouts)]


_READING: Final = 2.6
"""Processor seconds per megabyte of code, measured on 77 repositories (docs/cluster.md, "Volumes")."""
_WRITING: Final = 1.6
"""Seconds of wiring, rules and writing per megabyte of code, in the same measurement; in one process."""
_TRIPLES: Final = 40_000
"""Triples per megabyte of code, including inferred ones."""
_STORE_BYTES: Final = 14.5
"""Bytes of the store and its cache per byte of code."""


@dataclass(frozen=True, slots=True)
class Volume:
    """Volume of one source in a build: packages, files, bytes of code; and the part covered by earlier results.

    The other figures are estimates: processor seconds of reading, seconds of writing, triples including inferred ones,
    and bytes of the store.
    """

    source: str
    packages: int
    reused: int
    files: int
    code_bytes: int

    @property
    def reading(self) -> float:
        """Processor seconds of reading."""
        return self.code_bytes * _READING / 1e6

    @property
    def writing(self) -> float:
        """Seconds of wiring, rules and writing."""
        return self.code_bytes * _WRITING / 1e6

    @property
    def triples(self) -> int:
        """Triples, including inferred ones."""
        return round(self.code_bytes * _TRIPLES / 1e6)

    @property
    def store_bytes(self) -> int:
        """Bytes of the store and its cache."""
        return round(self.code_bytes * _STORE_BYTES)


def estimate(named: Sequence[str], settings: Settings, report: Report) -> list[Volume]:
    """Return the volume of a build of the sources `named`, by source.

    Git addresses are fetched: into the store if it exists, else into a temporary folder.

    Raises:
        SourceError: KG101, KG102, KG103 if a source cannot be read at all.
        StoreError: KG301 for a store of the settings that does not exist.
    """
    with TemporaryDirectory(prefix="kg-") as temporary:
        try:
            layout = layout_of(settings)
        except StoreError:
            if not named:
                raise
            layout = Layout(Path(temporary))
        state = load(layout.cache)
        sources = gather(named or state.roots, layout.checkouts, report, again=not named)
        workspace = Workspace(sources, installed_folders(settings))
        now = version(settings, layout.cache)
        plan = make_plan(workspace, state, layout.cache, now, settings.max_file_bytes)
    reading: dict[str, list[PackageFolder]] = {source.repository.name: [] for source in sources}
    for source, package in plan.read:
        reading[source.repository.name].append(package)
    return [_volume(source, reading[source.repository.name]) for source in sources]


def _volume(source: Source, read: list[PackageFolder]) -> Volume:
    files, code = sum(len(package.files) for package in read), sum(map(code_bytes, read))
    return Volume(source.repository.name, len(read), len(source.packages) - len(read), files, code)
