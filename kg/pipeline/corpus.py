"""Repositories of a lock file that the workers of a cluster fetch, for one build.

    with connected("tcp://scheduler:8786", report, {"/corpus/github.com/owner/robot": pin}) as corpus:
        corpus.fetch()
        corpus.sources, corpus.failed

The files of a repository remain on the machines of the workers. The build receives the list of the files, so it plans
and writes the graph as for a source in that folder.
"""

from __future__ import annotations

from contextlib import contextmanager
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Final

from kg.corpus.fetching.cache import fetch_source
from kg.corpus.fetching.lock import Entry
from kg.errors import Place, SourceError
from kg.pipeline.cluster import Cluster, announce, machine_of
from kg.pipeline.extracting import corpus_cache

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping

    from kg.corpus.files import Pin, Source
    from kg.pipeline.report import Report

_CERTAIN: Final = frozenset({"gone", "refused", "too large"})
"""States of repositories that another machine would not fetch either."""
_MOST_ATTEMPTS: Final = 5
"""How often a repository is tried until a second machine has tried it."""


@dataclass(slots=True)
class Corpus:
    """Pinned repositories by the folders that they would be in: `sources` are fetched, `failed` are not.

    `homes` contains the machines that fetched the sources.
    """

    pins: Mapping[str, Pin]
    cluster: Cluster
    sources: dict[str, Source] = field(default_factory=dict)
    failed: dict[str, Entry] = field(default_factory=dict)
    homes: dict[str, str] = field(default_factory=dict)

    def fetch(self) -> None:
        """Fetch those that are neither fetched nor failed. After a failure, another machine tries.

        Raises:
            SourceError: KG126 as `Cluster`, KG133 if none of several was fetched.
        """
        left = [folder for folder in self.pins if folder not in self.sources and folder not in self.failed]
        if left:
            self.cluster.connect()
        for folder in left:
            self._submit(folder)
        tried: dict[str, list[str]] = {folder: [] for folder in left}
        for folder, result in self.cluster.results():
            if isinstance(result, BaseException):  # its workers died repeatedly, or its code failed
                self.leave_out(folder, str(result))
                continue
            worker, entry, source = result
            tried[folder].append(machine_of(worker))
            if source is not None:
                self.sources[folder], self.homes[folder] = source, machine_of(worker)
            elif self._may_retry(tried[folder], entry) and self.cluster.has_other_machine(worker):
                self._submit(folder, f"!{machine_of(worker)}")
            else:
                self.failed[folder] = entry
        if self.pins and not self.sources:
            first = next(iter(self.failed.values()))
            reason = f"{first.state}: {first.reason}"
            message = f"no repository was fetched, of {len(self.pins)}; the first: {reason}"
            raise SourceError("KG133", message, place=Place(first.name))

    def leave_out(self, folder: str, reason: str) -> None:
        """Count a repository as failed."""
        pin = self.pins[folder]
        self.sources.pop(folder, None)
        self.failed[folder] = Entry(pin.name, pin.url, commit=pin.commit, state="failed", reason=reason)

    def _may_retry(self, machines: list[str], entry: Entry) -> bool:
        """Return whether another machine should try what `machines` could not fetch.

        Dask may still give it to the same one, if that one is idle first.
        """
        return entry.state not in _CERTAIN and len(set(machines)) == 1 and len(machines) < _MOST_ATTEMPTS

    def _submit(self, folder: str, near: str = "") -> None:
        pin = self.pins[folder]
        self.cluster.submit(folder, _fetch, pin, folder, key=f"fetch {pin.name}", near=near)


@contextmanager
def connected(address: str, report: Report, pins: Mapping[str, Pin]) -> Iterator[Corpus]:
    """Yield a cluster, connected when it is first needed, with the repositories that its workers fetch."""
    with Cluster(address, report) as cluster:
        yield Corpus(pins, cluster)


def _fetch(pin: Pin, folder: str) -> tuple[str, Entry, Source | None]:
    """Fetch a repository into the cache of this machine and return the address of the worker; runs on the cluster."""
    worker = announce(pin.name, fetching=True)
    return worker, *fetch_source(pin, Path(folder), corpus_cache())
