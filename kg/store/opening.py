"""Select the store: the one named by the settings, else the nearest `.kg` in this folder or above."""

from __future__ import annotations

from contextlib import ExitStack, contextmanager
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Final

from kg.lazily import lazily

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from kg.errors import UsageError
    from kg.settings import Settings
    from kg.store.snapshot import EmbeddedSnapshot

with lazily():
    import atexit
    import hashlib
    import shutil
    import tempfile

    from kg.store.embedded import EmbeddedStore
    from kg.store.failure import remote_refusal
    from kg.store.layout import Layout, create, find, user_cache
    from kg.store.union import union_of

_SERVERS: Final[dict[str, Layout]] = {}
"""The layouts of servers, by their address; each has a folder of this process or of the one that started it."""


def layout_of(settings: Settings) -> Layout:
    """Return the layout of the store in force; StoreError KG301 if there is none.

    No engine is loaded. That of a server has a folder of its own for its cache, which ends with the process;
    UsageError KG002 where a file of settings names it.
    """
    from kg.store.layout import FOLDER, PATIENT  # noqa: PLC0415 - start-up time

    if settings.store is None:
        return find(Path.cwd())
    if isinstance(settings.store, str):
        if settings.origin("store").kind == "file":
            raise _named_by_a_file(settings)
        return replace(_on_server(settings.store), silence=settings.timeout or PATIENT)
    inner = settings.store / FOLDER
    root = inner if inner.is_dir() else settings.store
    if not root.is_dir():
        from kg.errors import StoreError  # noqa: PLC0415 - only in this branch

        raise StoreError("KG301", f"no store at {settings.store} ({settings.origin('store')})")
    return Layout(root.absolute())


def take_layout(layout: Layout) -> None:
    """Use a layout that another process made for the server that has its data, here from now on."""
    if layout.address is not None:
        _SERVERS[layout.address] = layout


def _on_server(address: str) -> Layout:
    """Return the layout for a server, the same each time; its folder is temporary."""
    if address in _SERVERS:
        return _SERVERS[address]

    folder = tempfile.TemporaryDirectory(prefix="kg-")
    atexit.register(folder.cleanup)
    layout = Layout(Path(folder.name), address)
    layout.cache.mkdir()
    _SERVERS[address] = layout
    return layout


def _named_by_a_file(settings: Settings) -> UsageError:
    """Return the error about a server named by a file of settings, which may come from a foreign checkout."""
    from kg.errors import UsageError  # noqa: PLC0415 - only in this branch

    origin = settings.origin("store")
    hint = "Name the server with --store or KG_STORE."
    return UsageError("KG002", "kg.toml cannot name a server as the store", place=origin.place, hint=hint)


def mirrored(settings: Settings) -> Settings:
    """Return the settings with a store of this machine in the place of a server, whose data that store mirrors.

    It is in the user's folder for caches, and made where it is missing.
    """
    name = hashlib.blake2b(str(settings.store).encode(), digest_size=8).hexdigest()
    return replace(settings, store=create(user_cache() / "servers" / name).root)


def existing(settings: Settings) -> EmbeddedStore:
    """Return the selected store; StoreError KG301 if there is none."""
    return EmbeddedStore(layout_of(settings))


def reading(settings: Settings) -> EmbeddedSnapshot:
    """Return the current content of the selected store, for a `with` statement.

    The store may be a server named by the settings.
    """
    return existing(settings).read()


@contextmanager
def reading_with_cache(settings: Settings) -> Iterator[tuple[EmbeddedSnapshot, Path]]:
    """Yield the content of the store in force and the folder of its cache."""
    store = existing(settings)
    with store.read() as snapshot:
        yield snapshot, store.layout.cache


@contextmanager
def reading_all(settings: Settings, stores: Sequence[str]) -> Iterator[EmbeddedSnapshot]:
    """Yield the union of the stores named; for none, that of the selected store.

    Raises StoreError KG301 for the first missing one.
    """
    if len(stores) < 2:  # noqa: PLR2004 - a single store needs no union
        with reading(settings) as snapshot:
            yield snapshot
        return

    for name in stores:
        if "://" in name:
            raise remote_refusal(name)
    with ExitStack() as stack:
        opened = [stack.enter_context(reading(replace(settings, store=Path(name).expanduser()))) for name in stores]
        yield stack.enter_context(union_of(opened))


@contextmanager
def or_empty(settings: Settings) -> Iterator[Settings]:
    """Yield the settings, with an empty temporary store if none is named or found.

    Raises:
        StoreError: KG301 if the settings name a missing store.
    """
    from kg.errors import StoreError  # noqa: PLC0415 - start-up time

    try:
        layout_of(settings)
    except StoreError:
        if settings.store is not None:
            raise
    else:
        yield settings
        return

    from kg.store.layout import FOLDER  # noqa: PLC0415 - start-up time

    with tempfile.TemporaryDirectory(prefix="kg-") as folder:
        store = EmbeddedStore.create(Path(folder) / FOLDER)
        with store.write("kg serve") as transaction:
            transaction.replace_graphs({})
        yield replace(settings, store=store.layout.root)


@contextmanager
def writable(settings: Settings, *, create: bool = True) -> Iterator[EmbeddedStore]:
    """Yield the selected store, or a new one: at the path in the settings, else `.kg` in the working folder.

    A new store is deleted again if the body fails before writing. Without `create`, StoreError KG301 if there is none;
    KG306 for a folder of other files.
    """
    from kg.errors import Place, StoreError  # noqa: PLC0415 - start-up time
    from kg.store.layout import FOLDER  # noqa: PLC0415 - start-up time

    folder = Path.cwd() / FOLDER if settings.store is None else Path(settings.store)
    try:
        store, is_new = existing(settings), False
    except StoreError as error:
        if error.code != "KG301" or not create:
            raise
        store, is_new = EmbeddedStore.create(folder), True
    if not is_new and store.layout.address is None and store.layout.current() is None:
        foreign = store.layout.foreign_files()
        if foreign:
            hint = "Name a folder of its own with `--store`."
            message = f"the folder is not a store, and contains `{foreign[0]}`"
            raise StoreError("KG306", message, place=Place(str(store.layout.root)), hint=hint)
        EmbeddedStore.create(store.layout.root)
    try:
        yield store
    finally:
        if is_new and store.layout.current() is None:
            shutil.rmtree(store.layout.root, ignore_errors=True)
