"""The checks of `kg doctor`: each reports a finding and, if something is wrong, a fix."""

from __future__ import annotations

import platform
import shutil
import subprocess
import sys
from dataclasses import dataclass
from importlib.metadata import PackageNotFoundError, requires, version
from pathlib import Path
from typing import TYPE_CHECKING, Final

from kg.errors import CATALOGUE, KgError, StoreError
from kg.language.annotating import prepare
from kg.language.loading import describe
from kg.lazily import lazily
from kg.render.text import count
from kg.resources import folder
from kg.store.opening import layout_of

if TYPE_CHECKING:
    from collections.abc import Iterator

    from kg.settings import Settings
    from kg.store.layout import Layout

with lazily():
    from kg.server.libraries import libraries
    from kg.store.locks import busy
    from kg.store.snapshot import EmbeddedSnapshot

_DISTRIBUTION: Final = "kg-ros"
_LEAST_FREE: Final = 200 << 20


@dataclass(frozen=True, slots=True)
class Check:
    """The result of a check: `state` is ok, note (something optional is missing) or wrong."""

    subject: str
    state: str
    finding: str
    way_out: str = ""


def checks(settings: Settings) -> Iterator[Check]:
    """Yield the results of all checks, basic ones first."""
    yield Check("Python", "ok", f"{platform.python_version()} at {sys.executable}")
    yield from _dependencies()
    yield _data()
    yield _pages()
    yield _git()
    yield _java()
    yield _language(settings)
    yield from _store(settings)
    yield _disk(settings)
    for declaration, value, origin in settings.values():
        if origin.kind != "default":
            yield Check(f"setting {declaration.name}", "ok", f"{value} (from {origin})")


def _language(settings: Settings) -> Check:
    if settings.nlp_model:
        try:
            prepare(settings.nlp_model)
        except KgError as error:
            return Check("tagger", "wrong", str(error), error.hint or "")
    return Check("tagger", "ok", describe(settings.nlp_model))


def _dependencies() -> Iterator[Check]:
    try:
        own, needed = version(_DISTRIBUTION), requires(_DISTRIBUTION) or []
    except PackageNotFoundError:
        yield Check("kg", "note", "runs from a folder, not from an installation", "pip install .")
        return
    yield Check("kg", "ok", f"{own} at {Path(__file__).parents[1]}")
    for requirement in needed:
        name = requirement.split(";")[0].strip()
        bare = name.split("[")[0].split(">")[0].split("=")[0].split("<")[0].split("~")[0].split("!")[0].strip()
        extra = requirement.partition("extra ==")[2].strip(" '\"")
        if extra == "dev":
            continue
        try:
            yield Check(bare, "ok", version(bare))
        except PackageNotFoundError:
            way_out = (
                f"for some commands only: pip install '{_DISTRIBUTION}[{extra}]'" if extra else f"pip install '{name}'"
            )
            yield Check(bare, "note" if extra else "wrong", "not installed", way_out)


def _data() -> Check:
    missing = [name for name in ("ontology", "rules", "queries", "examples") if not folder(name).is_dir()]
    if missing:
        return Check("data files", "wrong", f"missing: {', '.join(missing)}", f"install {_DISTRIBUTION} again")
    return Check("data files", "ok", str(folder("ontology").parent))


def _pages() -> Check:
    from kg.server.libraries import HELP  # noqa: PLC0415 - start-up time

    if not libraries():
        finding = "their libraries are missing: no pictures, and a plain text field as the editor"
        return Check("pages", "note", finding, HELP)
    return Check("pages", "ok", count(len(libraries()), "library", "libraries"))


def _said(*command: str) -> str:
    """Return the first line of a program's output, empty if it cannot be run."""
    program = shutil.which(command[0])
    if program is None:
        return ""
    try:
        done = subprocess.run([program, *command[1:]], capture_output=True, text=True, check=False, timeout=20)  # noqa: S603 - a fixed program of the system
    except (OSError, subprocess.TimeoutExpired):
        return ""
    return (done.stdout or done.stderr).partition("\n")[0] if done.returncode == 0 else ""


def _git() -> Check:
    said = _said("git", "--version")
    way_out = "install git: without it commits are not known and addresses cannot be cloned"
    return Check("git", "ok", said) if said else Check("git", "wrong", "not found", way_out)


def _java() -> Check:
    said = _said("java", "-version")
    return Check("Java", "ok", said) if said else Check("Java", "note", "not found", CATALOGUE["KG603"].way_out)


def _store(settings: Settings) -> Iterator[Check]:
    try:
        layout = layout_of(settings)
    except KgError as error:
        state = "note" if settings.store is None else "wrong"
        finding = "none in this folder or above" if settings.store is None else error.message
        yield Check("store", state, finding, CATALOGUE[error.code].way_out)
        return
    yield _content(layout)

    holder = busy(layout)
    if holder is None:
        yield Check("writer", "ok", "none at work")
    else:
        yield Check("writer", "note", holder.message, holder.hint or "")


def _content(layout: Layout) -> Check:
    try:
        with EmbeddedSnapshot(layout) as snapshot:
            quads, graphs = snapshot.count(), len(snapshot.graphs())
            generation = snapshot.generation
    except StoreError as error:
        state = "note" if error.code == "KG301" else "wrong"
        return Check("store", state, f"{layout.root}: {error.message}", error.hint or CATALOGUE[error.code].way_out)
    held = sum(file.stat().st_size for file in layout.generation(generation).rglob("*") if file.is_file())
    return Check(
        "store",
        "ok",
        f"{layout.root}: generation {generation} ({len(layout.numbers())} kept), "
        f"{count(quads, 'quad')} in {count(graphs, 'graph')}, {held / 1e6:,.1f} MB",
    )


def _disk(settings: Settings) -> Check:
    place = Path(settings.store or Path.cwd())
    place = next(folder for folder in (place, *place.parents) if folder.exists())
    free = shutil.disk_usage(place).free
    finding = f"{free / 1e9:,.1f} GB free at {place}"
    if free < _LEAST_FREE:
        return Check("disk", "wrong", finding, "free some space, or put the store elsewhere with --store")
    return Check("disk", "ok", finding)
