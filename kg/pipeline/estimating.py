"""Estimates of the packages, files and time of a build, from a scan that opens no source file."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import TYPE_CHECKING, Final

from kg.corpus.workspace import Workspace
from kg.errors import StoreError
from kg.pipeline.plan import code_bytes, make_plan, version
from kg.pipeline.sources import gather, installed_folders
from kg.pipeline.state import load
from kg.store.layout import Layout
from kg.store.opening import layout_of

if TYPE_CHECKING:
    from collections.abc import Sequence

    from kg.corpus.files import PackageFolder, Source
    from kg.pipeline.report import Report
    from kg.settings import Settings

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
