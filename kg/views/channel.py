"""One topic, service or action: its users in launched systems and in code, and whether the ends are compatible."""

from __future__ import annotations

from dataclasses import asdict
from typing import TYPE_CHECKING, Any, Final

from kg.errors import UsageError
from kg.facts import Resolution
from kg.graph.iris import Iris
from kg.graph.reading.channels import (
    channels_called,
    defining_places,
    ends_in_code,
    findings_about,
    names,
    names_in,
    names_written,
    possible_ends,
    systems_at,
)
from kg.graph.reading.overview import channels
from kg.graph.reading.systems import system_names
from kg.graph.records import end_object, interface_object
from kg.names import normalise
from kg.similar import unknown
from kg.views.evidence import Places, places
from kg.views.system_rows import MISMATCHES, set_at
from kg.views.systems import chosen_systems
from kg.views.wording import quality

if TYPE_CHECKING:
    from collections.abc import Iterable

    from kg.facts import Interface, NodeInstance, NodeReference, System
    from kg.settings import Settings
    from kg.store.snapshot import EmbeddedSnapshot

_KINDS: Final = ("topic", "service", "action")
_DOUBTED: Final = frozenset({Resolution.PARAMETER_DEFAULT})
"""Resolutions whose reason tells when the name is another one."""
_SIDES: Final = 2
"""How many roles a topic, service or action has."""


def channel(
    snapshot: EmbeddedSnapshot, settings: Settings, *, name: str, kind: str = "topic", system: str = ""
) -> dict[str, Any]:
    """Return a topic, service or action (`kind`) called `name`, in launched systems and in code.

    `name` is absolute, a name in the code (`cmd_vel`, `~/plan`), a part of a name, or an IRI, which has a kind of its
    own; `system` names launch files to look at alone. The keys:

    * `kind`, `name` (the absolute name that is shown, None if several are meant), `iri`, `types`, `definitions`
      (evidence of the files that define the types), `systems` (names of the launch files that have it);
    * `meant`: what else the given name may mean; objects of name, `types`, `givers` and `takers` (`package/node`) and
      `systems` (how many launch files);
    * `endpoints`: one for each line of code of each start of a node, however many launch files include it. It has the
      fields of an interface in `kg instances --json` (docs/formats.md), and `role`, `title`, `types`, `quality`,
      `doubt` (when it has another name, part of `quality`), `instance` (None for code that no launch file starts
      under this name), `package` and `node` (its type), `node_iri`, `plugins` (`package/node` of the plugins with its
      code), `systems` (names of launch files), `possible` (it may have this name, and is on a side without others),
      `condition`, `launched` and `evidence` (the line that starts it, that of the code), `calls` (as in the view
      `node`), `set_at` (what gave it the name), `mismatches` (messages of the findings about it);
    * `findings`: `code`, `severity`, `message`, `systems` of those that say that types or QoS do not fit.

    Raises:
        UnknownNameError: KG001 with suggestions if there is none; KG422 for the launch file.
        UsageError: KG003 for another kind.
    """
    systems = chosen_systems(snapshot, system, settings.base)
    iris = Iris(settings.base)
    thing = iris.parse(name) if name.startswith(settings.base) else None
    if thing is not None and thing.kind in _KINDS:
        kind, name = thing.kind, thing.parts[0]
    chosen, others = resolve_channel(snapshot, kind, name, systems)
    summaries = (
        {one.name: asdict(one) for one in channels(snapshot, kind, implicit=True, named=others)} if others else {}
    )
    answer: dict[str, Any] = {
        "kind": kind,
        "name": chosen,
        "iri": iris.channel(kind, chosen) if chosen else None,
        "types": [],
        "definitions": [],
        "systems": [],
        "meant": [summaries[one] for one in others if one in summaries],
        "endpoints": [],
        "findings": [],
    }
    if chosen is None:
        return answer
    rows = _Endpoints(snapshot, settings)
    launched = []
    for each in systems_at(snapshot, kind, chosen, settings.base):
        own = each.configuration
        if systems is None or iris.configuration(own.repository, own.path) in systems:
            launched.append(each)
    endpoints = rows.of_systems(launched)
    if systems is None:
        endpoints += rows.of_code(ends_in_code(snapshot, kind, chosen, settings.base), launched)
        sides, types = {one["role"] for one in endpoints}, {type_ for one in endpoints for type_ in one["types"]}
        possible = possible_ends(snapshot, kind, chosen, types) if len(sides) < _SIDES else []
        endpoints += [
            {**one, "possible": True}
            for one in rows.of_code(possible, launched)
            if one["role"] not in sides and (not types or types.issuperset(one["types"]))
        ]
    findings = _findings(snapshot, settings, chosen, systems)
    for one in endpoints:
        one["mismatches"] = [
            finding["message"]
            for finding in findings
            if one["instance"] in finding["subjects"] and not set(one["systems"]).isdisjoint(finding["systems"])
        ]
    shown = sorted({one for end in endpoints for one in end["types"]})
    where = places(snapshot)
    return {
        **answer,
        "types": shown,
        "definitions": [where.evidence(*place) for place in defining_places(snapshot, shown)],
        "systems": sorted(one.configuration.name for one in launched),
        "endpoints": endpoints,
        "findings": findings,
    }


def resolve_channel(
    snapshot: EmbeddedSnapshot, kind: str, name: str, systems: frozenset[str] | None = None
) -> tuple[str | None, list[str]]:
    """Return the absolute name that `name` means, None if several; and the other names, sorted.

    It is a name in systems, a name in the code, an absolute one that code may have, or else a part of names: their
    beginning if it begins with a slash, otherwise their last segments, or any part. With IRIs of `systems` the names
    are theirs.

    Raises:
        UnknownNameError: KG001 with suggestions if there is none.
        UsageError: KG003 for another kind than topic, service or action.
    """
    if kind not in _KINDS:
        raise UsageError("KG003", f"`{kind}` is not a kind of name", hint=f"Use {', '.join(_KINDS)}.")
    written = normalise(name.strip())
    matches = names_written(snapshot, kind, written)
    absolute = written if written.startswith("/") else f"/{written}"
    if systems is None:
        there = (kind, absolute) in channels_called(snapshot, [absolute])
    else:
        candidates = names_in(snapshot, kind, systems)
        matches, there = [one for one in matches if one in candidates], absolute in candidates
    if there:
        return absolute, [one for one in matches if one != absolute]
    if not matches:
        if systems is None and written.startswith("/") and possible_ends(snapshot, kind, written):
            return written, []
        # Only a part of a name, or one that is not there, needs all names.
        candidates = names(snapshot, kind, implicit=True) if systems is None else candidates
        if written.strip("/~"):
            part = name.strip().lower()
            matches = [
                one for one in candidates if one.lower().startswith(part) or (part[0] != "/" and part in one.lower())
            ]
            matches = [one for one in matches if one.lower().endswith(f"/{part}")] or matches
            explicit = set(names(snapshot, kind))
            matches = [one for one in matches if one in explicit] or matches
        if not matches:
            raise unknown(kind, name, candidates, otherwise=f"`kg {kind}s` lists the {kind}s.")
    return (matches[0], []) if len(matches) == 1 else (None, matches)


def _findings(
    snapshot: EmbeddedSnapshot, settings: Settings, name: str, systems: frozenset[str] | None
) -> list[dict[str, Any]]:
    iris = Iris(settings.base)
    about = findings_about(snapshot, name)
    those = {iri for _, where in about.values() for iri in where if systems is None or iri in systems}
    named = {iris.configuration(one.repository, one.path): one.name for one in system_names(snapshot, those)}
    rows = []
    for (code, severity, message), (subjects, where) in about.items():
        inside = sorted({named[one] for one in where if one in named})
        if code in MISMATCHES and inside:
            rows.append(
                {"code": code, "severity": severity, "message": message, "systems": inside, "subjects": subjects}
            )
    return rows


class _Endpoints:
    """Rows of ends: one for each start of a node and line of code, with all the launch files that have it."""

    def __init__(self, snapshot: EmbeddedSnapshot, settings: Settings) -> None:
        self._where: Places = places(snapshot)
        self._iris = Iris(settings.base)

    def of_systems(self, systems: Iterable[System]) -> list[dict[str, Any]]:
        """Return the ends of instances, by role, name and place."""
        rows: dict[tuple[object, ...], dict[str, Any]] = {}
        for system in systems:
            source = system.configuration.repository
            for instance in system.instances:
                for end in instance.interfaces:
                    launched = self._where.evidence(source, instance.started.location)
                    doubt = end.reason if end.resolution in _DOUBTED else None
                    row = {
                        **end_object(end),
                        **self._common(end.declared, end.owner),
                        "doubt": doubt,
                        "quality": quality(end.switches, end.qos, doubt),
                        "instance": instance.name,
                        **self._type(instance, end.owner),
                        "condition": instance.started.condition,
                        "launched": launched,
                        "set_at": set_at(end, source, self._where),
                    }
                    key = (
                        *(row["role"], instance.name, row["node_iri"], str(instance.started.location), source),
                        *(str(end.declared.location), row["quality"], instance.started.condition),
                    )
                    self._fold(rows, key, row, system.configuration.name)
        return [rows[key] for key in sorted(rows, key=str)]

    def of_code(
        self, ends: Iterable[tuple[NodeReference, Interface]], systems: Iterable[System]
    ) -> list[dict[str, Any]]:
        """Return the ends of nodes that no launch file starts under the name, which they have when started alone."""
        started = {(end.owner, end.declared) for one in systems for each in one.instances for end in each.interfaces}
        rows: dict[tuple[object, ...], dict[str, Any]] = {}
        shown = {(owner, fact.role, fact.location) for owner, fact in started}
        for owner, fact in ends:
            if (owner, fact.role, fact.location) in shown:
                continue
            row = {
                **interface_object(fact),
                "owner": str(owner),
                "remap": None,
                "set_by": None,
                **self._common(fact, owner),
                "doubt": None,
                "quality": quality(fact.switches, fact.qos),
                "instance": None,
                "package": owner.package,
                "node": owner.node,
                "node_iri": self._iris.node(owner.repository, owner.package, owner.node),
                "condition": None,
                "launched": None,
                "set_at": None,
            }
            self._fold(rows, (fact.role, owner, str(fact.location), row["quality"]), row, None)
        return list(rows.values())

    def _common(self, fact: Interface, owner: NodeReference) -> dict[str, Any]:
        source = owner.repository
        return {
            "role": str(fact.role),
            "title": fact.role.heading,
            "types": [fact.type] if fact.type else [],
            "plugins": [],
            "systems": [],
            "evidence": self._where.evidence(source, fact.location),
            "calls": [self._where.evidence(source, one) for one in fact.via],
        }

    def _type(self, instance: NodeInstance, owner: NodeReference) -> dict[str, Any]:
        kind, started = instance.type, instance.started
        plugin = owner.node and owner != kind
        return {
            "package": kind.package if kind else started.package,
            "node": kind.node if kind else started.executable,
            "node_iri": self._iris.node(kind.repository, kind.package, kind.node) if kind else None,
            "plugins": [f"{owner.package}/{owner.node}"] if plugin else [],
        }

    @staticmethod
    def _fold(
        rows: dict[tuple[object, ...], dict[str, Any]], key: Any, row: dict[str, Any], system: str | None
    ) -> None:
        folded = rows.setdefault(key, row)
        for name in ("types", "plugins"):
            folded[name] = sorted({*folded[name], *row[name]})
        if system is not None:
            folded["systems"] = sorted({*folded["systems"], system})
