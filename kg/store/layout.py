"""Layout of a store's folder, its discovery, and the pointer to the current generation.

    .kg/current          pointer: {"layout": 1, "generation": 12}; replaced atomically, never edited
    .kg/store/12/        one generation: a RocksDB database that is never changed
    .kg/writer.lock      locked by the process that writes
    .kg/cache/           results of extraction (`kg.pipeline.cache`)
    .kg/cache/answers/   figures and lists of a generation (`kg.views.answers`)
    .kg/cache/columns/   input and output of the last run of rules (`kg.rules.memory`)
    .kg/changes/         which graphs each generation changed (`kg.store.changes`)
    .kg/checkouts/       clones of git addresses

The number of a generation is the identity of a snapshot, and is never reused.
"""

from __future__ import annotations

import json
import os
from collections.abc import Callable
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path
from typing import BinaryIO, Final

from kg.errors import Place, StoreError
from kg.store.failure import shown, translated

FOLDER: Final = ".kg"
"""Name of the folder of a store."""

LAYOUT: Final = 1
"""Version of this layout; a store of another version is refused (KG305)."""


PATIENT: Final = 3600.0
"""How many seconds a server may be silent where queries have no deadline."""


@dataclass(frozen=True, slots=True)
class Layout:
    """The paths of one store; `root` is the `.kg` folder itself.

    With an `address` the data is on a SPARQL server. The folder has its cache, and a pointer whose number changes
    when the data of the server does (`kg.store.following`). It never comes from a file: a folder that somebody else
    made cannot name a server.
    """

    root: Path
    address: str | None = None
    silence: float = PATIENT
    """How many seconds the server may be silent."""

    @property
    def name(self) -> str:
        """The address of the server that has the data, without what may be secret, else the folder."""
        return str(self.root) if self.address is None else shown(self.address)

    @property
    def pointer(self) -> Path:
        """The file that names the current generation."""
        return self.root / "current"

    @property
    def generations(self) -> Path:
        """The folder of the generations."""
        return self.root / "store"

    @property
    def lock(self) -> Path:
        """The lock file of the writer."""
        return self.root / "writer.lock"

    @property
    def cache(self) -> Path:
        """The folder of the results of extraction."""
        return self.root / "cache"

    @property
    def checkouts(self) -> Path:
        """The folder of clones of git addresses."""
        return self.root / "checkouts"

    def generation(self, number: int) -> Path:
        """Return the folder of one generation."""
        return self.generations / str(number)

    def foreign_files(self) -> list[str]:
        """Return the names of the entries of the folder that no store has, sorted."""
        own = {"cache", "changes", "checkouts", "store", "writer.lock", ".gitignore"}
        names = sorted(entry.name for entry in self.root.iterdir())
        return [name for name in names if name not in own and not name.startswith(self.pointer.name)]

    def numbers(self) -> list[int]:
        """Return the numbers of all generations that have a folder, current or not."""
        if not self.generations.is_dir():
            return []
        return sorted(int(entry.name) for entry in self.generations.iterdir() if entry.name.isdigit())

    def current(self) -> int | None:
        """Return the current generation, None before the first one.

        Raises:
            StoreError: KG303 if the pointer is malformed, KG305 if it has another layout.
        """
        place = Place(str(self.pointer))
        try:
            pointer = json.loads(self.pointer.read_bytes())
            layout, generation = pointer["layout"], pointer["generation"]
        except FileNotFoundError:
            return None
        except (OSError, ValueError, KeyError, TypeError) as error:
            raise StoreError("KG303", f"the pointer to the data cannot be read: {error}", place=place) from error
        if layout != LAYOUT:
            message = f"the store has layout {layout}; this kg reads layout {LAYOUT}"
            raise StoreError("KG305", message, place=place)
        if not isinstance(generation, int):
            raise StoreError("KG303", f"the pointer names no generation: {generation!r}", place=place)
        return generation

    def in_force(self) -> int | None:
        """Return the current generation, None if there is none or its data is gone; raises as `current`."""
        number = self.current()
        if self.address is not None:
            return number
        while number is not None and not self.generation(number).is_dir():
            # A writer may have replaced and deleted this generation after the pointer was read.
            missing, number = number, self.current()
            if number == missing:
                return None
        return number

    def switch(self, generation: int) -> None:
        """Make `generation` the current one, durably and atomically."""
        content = json.dumps({"layout": LAYOUT, "generation": generation}).encode()
        write_atomically(self.pointer, content + b"\n")


def write_atomically(path: Path, content: bytes | Callable[[BinaryIO], None], *, durable: bool = True) -> None:
    """Replace the content of `path` atomically: readers, also after a crash, see the old bytes or the new ones.

    A function writes its content to the file it receives, which is also readable. Without `durable`, a power failure
    may leave other bytes, for files whose content is checked.

    Raises:
        OSError: the temporary file could not be written; `path` is unchanged.
    """
    # Threads, and processes in two containers with the same process ID, may write the same file at the same time.
    temporary = path.with_name(f"{path.name}.{os.getpid()}-{os.urandom(4).hex()}.tmp")
    try:
        with temporary.open("w+b") as file:
            if callable(content):
                content(file)
            else:
                file.write(content)
            if durable:
                file.flush()
                os.fsync(file.fileno())
        temporary.replace(path)
    except BaseException:
        temporary.unlink(missing_ok=True)
        raise
    if durable:
        _sync_folder(path.parent)


def _sync_folder(path: Path) -> None:
    folder = os.open(path, os.O_RDONLY)
    try:
        os.fsync(folder)
    finally:
        os.close(folder)


def user_cache() -> Path:
    """Return the folder for unnamed stores, which may be deleted: in `$XDG_CACHE_HOME` or `~/.cache`."""
    given = Path(os.environ.get("XDG_CACHE_HOME", ""))
    return (given if given.is_absolute() else Path.home() / ".cache") / "kg"


def find(start: Path) -> Layout:
    """Return the store of the folder `start` or of the nearest folder above it.

    Raises:
        StoreError: KG301 if there is none.
    """
    start = start.absolute()
    for folder in (start, *start.parents):
        if (folder / FOLDER).is_dir():
            return Layout(folder / FOLDER)
    message = f"no {FOLDER} folder in {start} or the folders above it"
    raise StoreError("KG301", message, hint="Run `kg build FOLDER` or `kg demo` first.")


def create(root: Path) -> Layout:
    """Return the store whose folder is `root`, created if missing; version control ignores it.

    Raises:
        StoreError: KG304 if the disk is full, KG306 if the folder cannot be created.
    """
    layout = Layout(root.absolute())
    with translated(str(layout.root)):
        layout.generations.mkdir(parents=True, exist_ok=True)
        ignore = layout.root / ".gitignore"
        if not ignore.exists():
            ignore.write_text("*\n")
    return layout


def folder_bytes(folder: Path) -> int:
    """Return the total size of the files in a folder, even while a database deletes some."""
    size = 0
    for path in folder.iterdir():
        with suppress(FileNotFoundError):
            size += path.stat().st_size
    return size
