"""Backups of a store: a folder that is itself a store, or a file of N-Quads.

    back_up(layout, Path("monday"))            monday/ has one generation and backup.json; `kg --store monday` reads it
    back_up(layout, Path("monday.nq.gz"))      sorted lines, with canonical labels of blank nodes (RDFC-1.0)
    with store.write("kg restore") as transaction:
        restore(transaction, Path("monday"))

A backup contains the generation that was current when it began, so writers are not blocked. On one file system, the
folder shares the large files with the store (hard links), which takes milliseconds. It is written under a temporary
name and renamed when complete.
"""

from __future__ import annotations

import gzip
import json
import os
import shutil
from dataclasses import asdict, dataclass
from datetime import UTC, datetime
from typing import TYPE_CHECKING, Final

from pyoxigraph import BlankNode, CanonicalizationAlgorithm, Dataset, Quad, RdfFormat, Triple, serialize

from kg.errors import GraphError, Place, StoreError
from kg.store.failure import translated
from kg.store.layout import Layout
from kg.store.snapshot import EmbeddedSnapshot

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator
    from pathlib import Path

    from kg.store.transaction import EmbeddedTransaction

_MANIFEST: Final = "backup.json"
_FILES: Final = (".nq", ".nq.gz")


@dataclass(frozen=True, slots=True)
class Backup:
    """Manifest of a backup: the identity of the snapshot, the number of quads, and its time (ISO 8601)."""

    snapshot: int
    quads: int
    made: str


def is_file(target: Path) -> bool:
    """Return whether the name of a backup is that of an N-Quads file."""
    return target.name.endswith(_FILES)


def back_up(layout: Layout, target: Path) -> Backup:
    """Copy the current content to `target`, a folder or a file that must not exist.

    Raises:
        StoreError: KG301 without data, KG303 for a damaged store, KG304 full disk, KG306 if the target is not writable,
            KG566 if it exists.
    """
    if target.exists():
        raise StoreError(
            "KG566", "the file or folder already exists", place=Place(str(target)), hint="Name another one."
        )
    temporary = target.with_name(f"{target.name}.{os.getpid()}.tmp")
    try:
        with translated(str(target)), EmbeddedSnapshot(layout) as snapshot:
            target.absolute().parent.mkdir(parents=True, exist_ok=True)
            backup = Backup(snapshot.generation, snapshot.count(), datetime.now(UTC).isoformat(timespec="seconds"))
            if is_file(target):
                _write_file(snapshot, temporary, packed=target.suffix == ".gz")
            else:
                _write_folder(snapshot, Layout(temporary), backup)
            temporary.rename(target)
    finally:
        if temporary.is_dir():
            shutil.rmtree(temporary, ignore_errors=True)
        else:
            temporary.unlink(missing_ok=True)
    return backup


def _write_folder(snapshot: EmbeddedSnapshot, layout: Layout, backup: Backup) -> None:
    layout.generations.mkdir(parents=True)
    snapshot.backup(str(layout.generation(backup.snapshot)))
    (layout.root / _MANIFEST).write_text(json.dumps(asdict(backup)) + "\n", encoding="utf-8")
    layout.switch(backup.snapshot)


def _write_file(snapshot: EmbeddedSnapshot, path: Path, *, packed: bool) -> None:
    with path.open("wb") as file:
        if packed:
            # Omit name and time, so equal content has equal bytes.
            with gzip.GzipFile("", "wb", mtime=0, fileobj=file) as output:
                output.writelines(canonical(snapshot.quads()))
        else:
            file.writelines(canonical(snapshot.quads()))
        file.flush()
        os.fsync(file.fileno())


def canonical(quads: Iterable[Quad]) -> list[bytes]:
    """Return the N-Quads lines of quads, sorted, with the labels of RDFC-1.0 for blank nodes.

    Equal data gives equal bytes, whatever the original labels. Quads without blank nodes do not affect the labels.
    """
    plain: list[Quad] = []
    labelled = Dataset()
    for quad in quads:
        if any(isinstance(term, BlankNode) for term in _terms(quad)):
            labelled.add(quad)
        else:
            plain.append(quad)
    labelled.canonicalize(CanonicalizationAlgorithm.RDFC_1_0)
    written = serialize((*plain, *labelled), format=RdfFormat.N_QUADS) or b""
    return sorted(written.splitlines(keepends=True))


def _terms(statement: Quad | Triple) -> Iterator[object]:
    for term in (statement.subject, statement.object):
        if isinstance(term, Triple):
            yield from _terms(term)
        else:
            yield term
    if isinstance(statement, Quad):
        yield statement.graph_name


def restore(transaction: EmbeddedTransaction, source: Path) -> Backup | None:
    """Replace the content of the store with that of a backup.

    Returns its manifest, None for a file.

    Raises:
        StoreError: KG567 if it is not a backup, or incomplete.
        GraphError: KG601 for invalid N-Quads.
    """
    if not source.exists():
        raise _unusable(source, "there is nothing of this name")
    if source.is_file():
        transaction.start_from(None)
        try:
            transaction.load_file(source, RdfFormat.N_QUADS, keep_labels=True)
        except GraphError as error:
            if error.place is None or error.place.line is None:  # it is about the file, not a line of it
                raise _unusable(source, error.message) from error
            raise
        return None
    layout = Layout(source if (source / "current").exists() else source / ".kg")
    with EmbeddedSnapshot(layout) as snapshot:
        quads = snapshot.count()
        manifest = _manifest(layout, Backup(snapshot.generation, quads, ""))
        if manifest.quads != quads:
            raise _unusable(source, f"it holds {quads} quads, but its manifest lists {manifest.quads}")
        transaction.start_from(snapshot)
    return manifest


def _manifest(layout: Layout, default: Backup) -> Backup:
    """Return the manifest of a backup; `default` for any other store."""
    path = layout.root / _MANIFEST
    try:
        return Backup(**json.loads(path.read_bytes()))
    except FileNotFoundError:
        return default
    except (OSError, ValueError, TypeError) as error:
        raise _unusable(layout.root, f"its manifest cannot be read: {error}") from error


def _unusable(source: Path, message: str) -> StoreError:
    return StoreError("KG567", message, place=Place(str(source)), hint="Name what `kg backup` wrote.")
