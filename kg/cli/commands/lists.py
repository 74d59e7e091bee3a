"""`kg packages`, `kg files`, `kg topics`, `kg services`, `kg actions`: lists over the whole store."""

from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import asdict
from typing import Annotated, Any, Final

import typer

from kg.cli.diagnostics import note
from kg.cli.options import All, Json, require_one_of, with_settings
from kg.cli.output import Column, listing, terminal
from kg.lazily import lazily
from kg.render.text import count
from kg.settings import Settings
from kg.similar import unknown
from kg.store.opening import reading

with lazily():
    from kg.graph.reading import overview
    from kg.views.answers import channels

_SORTS: Final = ("code", "both", "text", "other")


@with_settings("store")
def packages(*, settings: Settings, json: Json = False) -> None:
    """List the packages with their nodes, interfaces and problems.

    Counts the nodes, interface definitions and problems of each package.
    """
    with reading(settings) as snapshot:
        listed = overview.packages(snapshot)
    columns = (
        Column("package", "name"),
        Column("version"),
        *(Column(title, "number") for title in ("ros", "nodes", "definitions", "problems")),
        Column("source", "dim", spare=1),
        Column("folder", "dim", spare=1),
    )
    rows = [
        (one.name, one.version, one.ros, one.nodes, one.definitions, one.problems, one.repository, one.folder)
        for one in listed
    ]
    listing(columns, rows, objects=map(asdict, listed) if json else None)
    if terminal() and not json:
        note(count(len(listed), "package"))


Package = Annotated[str | None, typer.Option("--package", "-p", metavar="NAME", help="Only files of this package.")]
Sort = Annotated[str | None, typer.Option("--sort", metavar="SORT", help=f"Only {', '.join(_SORTS)} files.")]


@with_settings("store")
def files(
    *,
    settings: Settings,
    package: Package = None,
    sort: Sort = None,
    json: Json = False,
) -> None:
    """List the files of packages, sorted into code and text.

    As in RNKG (section 3.1.2), code is C++, Python, interface definitions and launch files; text is READMEs, pages and
    the comments of code (`both`). Manifests, build files and parameters are `other`. Counts the node types made from a
    file, and the descriptions taken from it. For example:

        kg files --package rover_robot
        kg files --sort text
    """
    if sort is not None:
        require_one_of(sort, _SORTS, "sort")
    with reading(settings) as snapshot:
        every = overview.files(snapshot)
    selected = [one for one in every if sort in {None, one.sort} and package in {None, one.package}]
    if package is not None and not selected and package not in {one.package for one in every}:
        raise unknown("package", package, {one.package for one in every}, otherwise="`kg packages` lists them.")
    columns = (
        Column("sort"),
        Column("kind"),
        *(Column(title, "number") for title in ("nodes", "texts")),
        Column("package", "name"),
        Column("file"),
        Column("source", "dim", spare=1),
    )
    rows = [(one.sort, one.kind, one.nodes, one.texts, one.package, one.path, one.repository) for one in selected]
    listing(columns, rows, objects=map(asdict, selected) if json else None)
    if terminal() and not json:
        counts = Counter(one.sort for one in selected)
        note(", ".join(f"{counts[one]} {one}" for one in _SORTS if counts[one]) or "no files")


@with_settings("store")
def topics(*, settings: Settings, every: All = False, json: Json = False) -> None:
    """List the topics with their types and numbers of nodes.

    Names are those in launched systems, after remapping, and those of nodes started alone. `kg topic NAME` shows one.
    """
    _list(settings, "topic", every=every, json=json)


@with_settings("store")
def services(*, settings: Settings, every: All = False, json: Json = False) -> None:
    """List the services with their types and numbers of nodes.

    `kg service NAME` shows one.
    """
    _list(settings, "service", every=every, json=json)


@with_settings("store")
def actions(*, settings: Settings, every: All = False, json: Json = False) -> None:
    """List the actions with their types and numbers of nodes.

    `kg action NAME` shows one.
    """
    _list(settings, "action", every=every, json=json)


def _list(settings: Settings, kind: str, *, every: bool, json: bool) -> None:
    with reading(settings) as snapshot:
        rows = [asdict(one) for one in channels(snapshot, kind, implicit=every)]
    channel_rows(kind, rows, json=json)
    if terminal() and not json:
        note(count(len(rows), kind))


def channel_rows(kind: str, listed: "Sequence[Mapping[str, Any]]", *, json: bool = False) -> None:
    """Write topics, services or actions as a list: objects as of `kg.graph.reading.overview.Channel`."""
    verbs = ("publish", "subscribe") if kind == "topic" else ("offer", "call")
    columns = (
        Column(kind, "name"),
        Column("type", spare=1),
        *(Column(verb, "number") for verb in verbs),
        Column("launch files", "number"),
    )
    rows = [
        (one["name"], ", ".join(one["types"]), len(one["givers"]), len(one["takers"]), one["systems"]) for one in listed
    ]
    givers, takers = (f"{verb}ed_by" if verb[-1] != "e" else f"{verb}d_by" for verb in verbs)
    objects = (
        {
            kind: one["name"],
            "types": one["types"],
            givers: one["givers"],
            takers: one["takers"],
            "systems": one["systems"],
        }
        for one in listed
    )
    listing(columns, rows, objects=objects if json else None)
