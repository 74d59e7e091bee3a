"""Results of extraction shared by machines, found by a digest of the version of `kg` and of their inputs.

    artifacts = Artifacts("/shared/kg-artifacts")       # or any address that fsspec opens, such as s3://bucket/kg
    found = artifacts.result(version, job, source, package, read)

The key of a package is computed from the version of `kg`, its settings and the package's own files. Other dependencies
of a result (look-ups, files of other packages) are recorded in it and compared when it is found, so a key may have
several results. The name of a file contains the digest of its content: partial, damaged or foreign files are never
used.
"""

from __future__ import annotations

import os
import zlib
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final, TypeVar

from kg.corpus.files import Source  # noqa: TC001 - results are read by these annotations
from kg.errors import Place, SourceError, UsageError
from kg.lazily import lazily
from kg.pipeline import cache
from kg.pipeline.plan import listing, mark_of
from kg.pipeline.recording import RecordingWorkspace, answer
from kg.pipeline.visible import digest
from kg.pipeline.work import Job, Outcome

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Mapping

    from kg.corpus.files import PackageFolder

with lazily():
    from msgspec import msgpack

_NAME_CHARS: Final = 32
"""Length of the name of a result, the digest of its content."""
_JOBS: Final = "jobs"
_RESULTS: Final = "results"
_Content = TypeVar("_Content")


@dataclass(frozen=True, slots=True)
class StoredResult:
    """A stored result: its name, and the problems for the report of a build."""

    name: str
    outcome: Outcome


@dataclass(frozen=True, slots=True)
class _Build:
    """Content of the file of a job: the description of a build for its workers."""

    version: str
    code: str
    base: str
    max_file_bytes: int
    model: str
    calls: tuple[str, ...]
    sources: tuple[Source, ...]
    installed: tuple[Path, ...] = field(default_factory=tuple)


class Artifacts:
    """Results and jobs in a folder, or at an address that fsspec opens.

    Raises:
        UsageError: KG125 without the extra `cluster`.
        SourceError: KG128 if the address is unusable; also for each failed write.
    """

    def __init__(self, address: str) -> None:
        try:
            from fsspec.core import url_to_fs  # noqa: PLC0415 - part of the extra `cluster`
        except ImportError as error:
            raise without_extra() from error
        self.address = address if "://" in address else str(Path(address).absolute())
        try:
            self._files, self._root = url_to_fs(self.address)
        except (ImportError, OSError, ValueError) as error:
            raise self._unusable(error) from error

    def keep_job(self, version: str, code: str, job: Job) -> str:
        """Write the job of a build for its workers, and return its name.

        `version` is the version of results, `code` the digest of the code that computes them.
        """
        workspace = job.workspace
        described = _Build(
            version, code, job.base, job.max_file_bytes, job.model, job.calls, workspace.sources, workspace.installed
        )
        return self._write(_JOBS, zlib.compress(_encode(described), 1))

    def job(
        self, name: str, kind: Callable[[Iterable[Source], Iterable[Path]], RecordingWorkspace] = RecordingWorkspace
    ) -> tuple[str, str, Job]:
        """Return the version of results and the digest of the code of a build, and its job, prepared for look-ups.

        `kind` creates its workspace.

        Raises:
            SourceError: KG128 if it is missing or damaged.
        """
        content = self._read(name)
        described = _decode(zlib.decompress(content), _Build) if content else None
        if described is None:
            hint = "Use a folder that all workers can read under the same path, and the same kg everywhere."
            message = f"the description of the build, {name}, is missing or of another version of kg"
            raise SourceError("KG128", message, place=Place(self.address), hint=hint)
        workspace = kind(described.sources, described.installed)
        workspace.prepare()
        job = Job(workspace, described.base, described.max_file_bytes, described.model, None, described.calls)
        return described.version, described.code, job

    def result(
        self, version: str, job: Job, source: Source, package: PackageFolder, read: Callable[[], Outcome]
    ) -> StoredResult:
        """Return the current result of a package in the build of `job`; if missing, `read` it and store it.

        A result that the next build must not reuse is not stored; its name is empty.
        """
        repository = source.repository.name
        keys = [f"{repository}:{one.path}" for one in package.files]
        marks = {key: mark_of(job.workspace, key, job.max_file_bytes) for key in keys}
        listed = [version, repository, package.path, listing(package), *map(" ".join, marks.items())]
        key = digest("\n".join(listed).encode("utf-8", "surrogateescape"))
        folder = f"{_RESULTS}/{key[:2]}/{key}"
        for name in self._names(folder):
            outcome = self.outcome(name)
            if outcome is not None and _holds(job, outcome, marks):
                return StoredResult(name, outcome)
        outcome = read()
        return StoredResult(self._write(folder, _encode(outcome)) if outcome.reusable else "", outcome)

    def outcome(self, name: str) -> Outcome | None:
        """Return a result by its name; None if it is missing or damaged."""
        content = self._read(name)
        return _decode(content, Outcome) if content else None

    def _names(self, folder: str) -> Iterable[str]:
        try:
            paths: list[str] = self._files.ls(f"{self._root}/{folder}", detail=False)
        except OSError:
            return ()
        names = (path.rpartition("/")[2] for path in paths)
        return sorted(f"{folder}/{name}" for name in names if len(name) == _NAME_CHARS)

    def _read(self, name: str) -> bytes | None:
        """Return the content of a file; None if it is missing, or damaged and then deleted."""
        path = f"{self._root}/{name}"
        try:
            content: bytes = self._files.cat_file(path)
        except OSError:
            return None
        if digest(content) == name.rpartition("/")[2]:
            return content
        self._remove(path)
        return None

    def _write(self, folder: str, content: bytes) -> str:
        """Write a file under a temporary name, then rename it. A named file is always complete."""
        name = f"{folder}/{digest(content)}"
        temporary = f"{self._root}/{folder}/{os.urandom(8).hex()}.tmp"
        try:
            self._files.makedirs(f"{self._root}/{folder}", exist_ok=True)
            self._files.pipe_file(temporary, content)
            self._files.mv(temporary, f"{self._root}/{name}")
        except OSError as error:
            self._remove(temporary)
            raise self._unusable(error) from error
        return name

    def _remove(self, path: str) -> None:
        if self._files.exists(path):
            self._files.rm_file(path)

    def _unusable(self, error: Exception) -> SourceError:
        words = getattr(error, "strerror", None) or str(error)
        hint = "Name a folder that all machines can write to under the same path, or an address that fsspec opens."
        return SourceError("KG128", f"the store of results: {words}", place=Place(self.address), hint=hint)


def without_extra() -> UsageError:
    """Return the error of a command that needs the extra `cluster`."""
    hint = "Install the extra: pip install 'kg-ros[cluster]'"
    return UsageError("KG125", "builds on a cluster need Dask, which is not installed", hint=hint)


def _holds(job: Job, outcome: Outcome, marks: Mapping[str, str]) -> bool:
    """Return whether all inputs of a result are unchanged; `marks` are those of the package's own files."""
    recorded = {**cache.lookups_of(outcome.packed), **outcome.outside}
    if any(answer(job.workspace, lookup) != before for lookup, before in recorded.items()):
        return False
    limit = job.max_file_bytes
    return all((marks.get(key) or mark_of(job.workspace, key, limit)) == mark for key, mark in outcome.inputs.items())


def _encode(content: Any) -> bytes:
    return msgpack.encode(content, enc_hook=str)


def _decode(content: bytes, kind: type[_Content]) -> _Content | None:
    """Return the content of a file; None if it has another form, written by another version of `kg`."""
    from msgspec import DecodeError  # noqa: PLC0415 - start-up time

    try:
        return msgpack.decode(content, type=kind, dec_hook=lambda wanted, value: wanted(value))
    except DecodeError:
        return None
