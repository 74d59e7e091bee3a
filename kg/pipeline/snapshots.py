"""Published graphs: a folder, local or on a web server, from which `kg pull` creates a store.

    manifest.json            content of the snapshot, with sizes and digests; written last
    graph-DIGEST.nq.gz       all quads, sorted (`kg.store.backups.canonical`)
    index-DIGEST             the search index, if one was built
    rules/FAMILY/NAME.rq     the publisher's own rules

A snapshot is untrusted. Its files are fetched into a temporary folder, up to the sizes in the manifest and the limit of
the caller, and their digests are checked before anything is read. The graph is parsed as N-Quads; nothing is executed.
Rules are stored where no command searches for them.
"""

from __future__ import annotations

import gzip
import hashlib
import os
import re
import shutil
import tempfile
from contextlib import contextmanager
from dataclasses import asdict, dataclass
from datetime import UTC, datetime
from importlib.metadata import version
from pathlib import Path
from typing import IO, TYPE_CHECKING, Final
from urllib.parse import unquote, urlsplit

from kg.errors import Place, StoreError
from kg.lazily import lazily
from kg.pipeline.updating.restoring import restore
from kg.store.backups import canonical
from kg.store.failure import translated
from kg.store.http import Endpoint
from kg.store.layout import write_atomically

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from kg.store.embedded import EmbeddedStore
    from kg.store.snapshot import EmbeddedSnapshot

with lazily():
    from msgspec import json

_FORM: Final = 1
_MANIFEST: Final = "manifest.json"
_KEPT: Final = "published"
"""Folder in a store for the manifest and the rules of the snapshot that it was created from."""
_MANIFEST_BYTES: Final = 4 << 20
_CHUNK: Final = 1 << 20
_RULE_ENDINGS: Final = (".rq", ".srl", ".ttl")
_SAFE: Final = re.compile(r"(?:graph-[0-9a-f]{32}\.nq\.gz|index-[0-9a-f]{32}|rules(?:/\w[\w.-]*){1,8})", re.ASCII)
"""Allowed names of files: none is absolute, hidden, or outside the folder."""


@dataclass(frozen=True, slots=True)
class Part:
    """A file of a snapshot: its path in it, its size, and its BLAKE2b digest of 16 bytes."""

    path: str
    bytes: int
    digest: str


@dataclass(frozen=True, slots=True)
class Manifest:
    """Content of a snapshot.

    `snapshot` is the generation of the publisher's store, `made` a time (ISO 8601), `unpacked` the size of the graph as
    N-Quads in bytes, `digest` its digest: equal graphs have equal digests.
    """

    form: int
    kg: str
    base: str
    snapshot: int
    made: str
    quads: int
    unpacked: int
    digest: str
    graph: Part
    index: Part | None = None
    rules: tuple[Part, ...] = ()

    @property
    def parts(self) -> tuple[Part, ...]:
        """Return all files."""
        return (self.graph, *((self.index,) if self.index else ()), *self.rules)


def publish(
    snapshot: EmbeddedSnapshot, address: str, base: str, rules: Sequence[Path] = (), index: Path | None = None
) -> Manifest:
    """Write a snapshot with the rules in folders and a search index to a folder, or to a web server by PUT.

    An earlier snapshot there is replaced; a client that fetches during the replacement gets either one.

    Raises:
        StoreError: KG225 if the server refuses, KG304, KG306 if the folder cannot be written, KG566 for a folder
            with other content.
    """
    place = _place(address)
    if isinstance(place, Path) and place.exists() and any(place.iterdir()) and not (place / _MANIFEST).exists():
        raise StoreError(
            "KG566", "the folder contains something else", place=Place(str(place)), hint="Name another folder."
        )
    with translated(address), tempfile.TemporaryDirectory(prefix="kg-") as temporary:
        folder = Path(temporary)
        lines = canonical(snapshot.quads())
        digest, unpacked = hashlib.blake2b(digest_size=16), 0
        with (folder / "graph").open("wb") as file, gzip.GzipFile("", "wb", mtime=0, fileobj=file) as output:
            for line in lines:
                digest.update(line)
                unpacked += len(line)
                output.write(line)
        graph = _part(folder / "graph", "graph-{}.nq.gz")
        files = {graph: folder / "graph"}
        index_file = None
        if index is not None and index.is_file():
            index_file = _part(index, "index-{}")
            files[index_file] = index
        own = {_part(path, f"rules/{name}"): path for name, path in sorted(_rules(rules).items())}
        time = datetime.now(UTC).isoformat(timespec="seconds")
        manifest = Manifest(
            form=_FORM,
            kg=version("kg-ros"),
            base=base,
            snapshot=snapshot.generation,
            made=time,
            quads=len(lines),
            unpacked=unpacked,
            digest=digest.hexdigest(),
            graph=graph,
            index=index_file,
            rules=tuple(own),
        )
        for part, path in (files | own).items():
            _send(place, part.path, path)
        (folder / "manifest").write_bytes(json.format(json.encode(asdict(manifest))) + b"\n")
        _send(place, _MANIFEST, folder / "manifest")
    if isinstance(place, Path):
        _delete_old_parts(place, manifest)
    return manifest


def pull(address: str, store: EmbeddedStore, max_bytes: int, *, with_index: bool = False) -> Manifest:
    """Replace the content of a store by a published snapshot, as a new generation; on errors the store is unchanged.

    At most `max_bytes` bytes are fetched, and unpacked. `with_index` also fetches the search index, which is not
    checked against the graph. Rules are written to the folder `published/rules` of the store.

    Raises:
        StoreError: KG225 if the server does not respond, KG307 if it is not a snapshot, or incomplete, KG308 if it is
            too large, KG566 for a store that was not pulled; and as writing a store does.
        GraphError: KG601 for a graph that is not valid N-Quads.
    """
    local = store.layout.root / _KEPT
    if store.layout.current() is not None and not (local / _MANIFEST).exists():
        hint = "Name a new folder with `--store`."
        raise StoreError("KG566", "the store was built here", place=Place(str(store.layout.root)), hint=hint)
    place = _place(address)
    with _temporary_folder(store.layout.root) as folder:
        (folder / _MANIFEST).write_bytes(b"")
        _receive(place, _MANIFEST, folder / _MANIFEST, _MANIFEST_BYTES)
        manifest = _decoded((folder / _MANIFEST).read_bytes(), address)
        if sum(part.bytes for part in manifest.parts) > max_bytes or manifest.unpacked > max_bytes:
            message = f"the snapshot has {manifest.unpacked:,} bytes unpacked, and the limit is {max_bytes:,}"
            raise StoreError("KG308", message, place=Place(address), hint="Raise it with --max-bytes.")
        wanted = [part for part in manifest.parts if part is not manifest.index or with_index]
        for part in wanted:
            target = folder / part.path
            target.parent.mkdir(parents=True, exist_ok=True)
            _receive(place, part.path, target, part.bytes)
            if target.stat().st_size != part.bytes or _file_digest(target) != part.digest:
                raise _unusable(address, f"{part.path} differs from the manifest")
        _unpack(folder, manifest, address)
        restored = restore(store, folder / "graph.nq")
        if manifest.index and with_index:
            target = store.layout.cache / "search" / str(restored.snapshot)
            target.parent.mkdir(parents=True, exist_ok=True)
            shutil.copyfile(folder / manifest.index.path, target)
        # Manifest and rules replace those of the previous snapshot.
        shutil.rmtree(local, ignore_errors=True)
        local.mkdir(parents=True)
        if (folder / "rules").is_dir():
            shutil.copytree(folder / "rules", local / "rules")
        write_atomically(local / _MANIFEST, (folder / _MANIFEST).read_bytes())
    return manifest


def _unpack(folder: Path, manifest: Manifest, address: str) -> None:
    """Write the graph as N-Quads, unpacking at most the size in the manifest."""
    digest, left = hashlib.blake2b(digest_size=16), manifest.unpacked
    try:
        with gzip.open(folder / manifest.graph.path) as file, (folder / "graph.nq").open("wb") as output:
            while chunk := file.read(min(_CHUNK, left + 1)):
                left -= len(chunk)
                if left < 0:
                    raise StoreError("KG308", "the graph is larger than the size in its manifest", place=Place(address))
                digest.update(chunk)
                output.write(chunk)
    except (EOFError, gzip.BadGzipFile, ValueError) as error:
        raise _unusable(address, f"the graph cannot be unpacked: {error}") from error
    if left or digest.hexdigest() != manifest.digest:
        raise _unusable(address, "the graph differs from the manifest")


@contextmanager
def _temporary_folder(root: Path) -> Iterator[Path]:
    """Yield a temporary folder on the same disk as the store."""
    with translated(str(root)):
        root.mkdir(parents=True, exist_ok=True)
        with tempfile.TemporaryDirectory(prefix="pull-", dir=root) as folder:
            yield Path(folder)


def _rules(folders: Sequence[Path]) -> dict[str, Path]:
    """Return the files of rules in folders by their path in the snapshot; later folders take precedence."""
    files = {}
    for folder in folders:
        for path in folder.rglob("*"):
            name = path.relative_to(folder).as_posix()
            if path.suffix in _RULE_ENDINGS and path.is_file() and _SAFE.fullmatch(f"rules/{name}"):
                files[name] = path
    return files


def _place(address: str) -> Path | str:
    """Return the location of a snapshot: a folder, or an HTTP address without trailing slash."""
    parts = urlsplit(address)
    if parts.scheme in {"http", "https"}:
        if parts.username is not None:
            hint = "Set KG_REMOTE_USER and KG_REMOTE_PASSWORD, or KG_REMOTE_TOKEN."
            raise StoreError(
                "KG225", "credentials do not belong on the command line", place=Place(parts.hostname or ""), hint=hint
            )
        return address.rstrip("/")
    if parts.scheme == "file":
        return Path(unquote(parts.path))
    if "://" in address:
        hint = "Name a folder, or an address of http, https or file."
        raise StoreError("KG307", f"snapshots are not fetched by {parts.scheme}", place=Place(address), hint=hint)
    return Path(address)


def _send(place: Path | str, name: str, path: Path) -> None:
    if isinstance(place, str):
        with path.open("rb") as file:
            Endpoint(f"{place}/{name}", from_environment=True).put(file, path.stat().st_size)
        return
    target = place / name
    target.parent.mkdir(parents=True, exist_ok=True)
    temporary = target.with_name(f"{target.name}.{os.getpid()}.tmp")
    shutil.copyfile(path, temporary)
    temporary.replace(target)


def _receive(place: Path | str, name: str, target: Path, limit: int) -> None:
    with target.open("wb") as file:
        if isinstance(place, str):
            Endpoint(f"{place}/{name}", from_environment=True).get(file, limit)
            return
        try:
            with (place / name).open("rb") as source:
                _copy(source, file, limit, place / name)
        except OSError as error:
            raise _unusable(str(place / name), error.strerror or str(error)) from error


def _copy(source: IO[bytes], target: IO[bytes], limit: int, place: Path) -> None:
    while chunk := source.read(_CHUNK):
        limit -= len(chunk)
        if limit < 0:
            raise StoreError("KG308", "the file is larger than the size in its manifest", place=Place(str(place)))
        target.write(chunk)


def _delete_old_parts(folder: Path, manifest: Manifest) -> None:
    """Delete the files of earlier snapshots."""
    current = {part.path for part in manifest.parts}
    for path in folder.rglob("*"):
        name = path.relative_to(folder).as_posix()
        if path.is_file() and _SAFE.fullmatch(name) and name not in current:
            path.unlink()


def _part(path: Path, name: str) -> Part:
    digest = _file_digest(path)
    return Part(name.format(digest), path.stat().st_size, digest)


def _file_digest(path: Path) -> str:
    with path.open("rb") as file:
        return hashlib.file_digest(file, lambda: hashlib.blake2b(digest_size=16)).hexdigest()


def _decoded(content: bytes, address: str) -> Manifest:
    from msgspec import DecodeError  # noqa: PLC0415 - start-up time

    try:
        manifest = json.decode(content, type=Manifest)
    except (DecodeError, UnicodeDecodeError) as error:
        raise _unusable(address, f"the manifest cannot be read: {error}") from error
    if manifest.form != _FORM:
        raise _unusable(address, f"the manifest has form {manifest.form}, and this kg reads form {_FORM}")
    for part in manifest.parts:
        if not _SAFE.fullmatch(part.path) or part.bytes < 0:
            raise _unusable(address, f"the manifest names {part.path!r}, which is not a file of a snapshot")
    names = [manifest.graph.path.startswith("graph-"), *(part.path.startswith("rules/") for part in manifest.rules)]
    if not all(names) or (manifest.index and not manifest.index.path.startswith("index-")):
        raise _unusable(address, "the manifest names a file for another purpose")
    return manifest


def _unusable(address: str, message: str) -> StoreError:
    return StoreError("KG307", message, place=Place(address), hint="Name what `kg publish` wrote.")
