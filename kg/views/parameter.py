"""One parameter: which code declares it, which files set it, and the value that each start of a node has."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, Any

from kg.graph.iris import Iris
from kg.graph.reading.parameters import (
    SetParameter,
    declarations,
    declared_among,
    declared_names,
    set_names,
    set_parameters,
    starts,
    types_started,
    unknown_files,
)
from kg.graph.reading.systems import system_names
from kg.graph.records import parameter_object
from kg.holes import fits, is_partial, known_letters
from kg.similar import unknown
from kg.views.evidence import places
from kg.views.systems import chosen_systems
from kg.views.wording import accesses, parameter_groups

if TYPE_CHECKING:
    from collections.abc import Collection, Iterable, Mapping, Sequence

    from kg.facts import NodeReference, Parameter
    from kg.settings import Settings
    from kg.store.snapshot import EmbeddedSnapshot


def parameter(snapshot: EmbeddedSnapshot, settings: Settings, *, name: str, system: str = "") -> dict[str, Any]:
    """Return a parameter, in code and in every launched system.

    `name` is that in the code (`rate`), that in a parameter file (`FollowPath.speed`), one with the node in front
    (`/controller_server/rate`), or a part of such names. `system` names launch files to look at alone. The keys:

    * `name` (None if several are meant), `meant` (the names, where there are several);
    * `declared`: one for each node type, with the fields of a parameter in `kg nodes --json` (docs/formats.md), and
      `package`, `node`, `node_iri`, `accesses` (words), `evidence`, `calls`;
    * `values`: one for each start of a node, however many launch files include it: `parameter` (its absolute name),
      `instance` (None where it is set for all nodes), `value` (None where it is not known), `reason`, `set_at`
      (evidence of the line that sets it, None for the default in the code), `launched` (evidence), `systems` (names of
      launch files).

    Raises UnknownNameError: KG001 with suggestions if there is none; KG422 for the launch file.
    """
    written = name.strip().removeprefix("~/")
    last, absolute = written.rpartition("/")[2], written.startswith("/")
    set_values = set_parameters(snapshot, written) if last else []
    declared = declared_among(snapshot, _spellings(written)) if last else set()
    # All names are read only for a name that nothing has.
    names = [] if declared or set_values else declared_names(snapshot)
    # A name with unknown parts may be the one that is given, unless nothing of it is known.
    declared = declared or {
        one for one in names if is_partial(one) and known_letters(one) > 0 and fits(one, written, "[^/]+")
    }
    owners = {written[:at] for at, sign in enumerate(written) if at and sign == "/"} if absolute else None
    types = None if owners is None else types_started(snapshot, owners)
    code = declarations(snapshot, declared, {one.declared for one in set_values if one.declared}, types)
    view = _View(snapshot, settings, chosen_systems(snapshot, system, settings.base))
    set_values += [one for one in view.defaults(code, set_values, owners) if not absolute or one.absolute == written]
    if absolute:
        started, set_here = {one.start.type for one in set_values if one.start}, {one.declared for one in set_values}
        code = {
            iri: (owner, fact)
            for iri, (owner, fact) in code.items()
            if iri in set_here or view.node(owner) in started or fact.name == written
        }
    if not set_values and not code:
        names = names or declared_names(snapshot)
        every = {one.removeprefix("~/") for one in names if not is_partial(one)} | set(set_names(snapshot))
        candidates = sorted(one for one in every if last and one != written and written.lower() in one.lower())
        if not candidates:
            raise unknown("parameter", name, every, otherwise="`kg node NAME` lists the parameters of a node.")
        if len(candidates) > 1:
            return {"name": None, "meant": candidates, "declared": [], "values": []}
        return parameter(snapshot, settings, name=candidates[0], system=system)
    return {"name": written, "meant": [], "declared": view.declared(code.values()), "values": view.values(set_values)}


def _spellings(written: str) -> set[str]:
    """Return the names in code that may be the one that is given, which may have that of a node in front."""
    ends = {written}
    if written.startswith("/"):
        ends |= {written[at + 1 :] for at, sign in enumerate(written) if sign == "/"}
    return ends | {f"~/{one}" for one in ends}


class _View:
    def __init__(self, snapshot: EmbeddedSnapshot, settings: Settings, chosen: frozenset[str] | None) -> None:
        self._snapshot = snapshot
        self._where = places(snapshot)
        self._iris = Iris(settings.base)
        self._chosen = chosen

    def declared(self, uses: Iterable[tuple[NodeReference, Parameter]]) -> list[dict[str, Any]]:
        """Return the uses of the parameter in code, a row for each node type."""
        by_node: dict[NodeReference, list[Parameter]] = {}
        for owner, fact in uses:
            by_node.setdefault(owner, []).append(fact)
        return [
            {
                **parameter_object(group[0]),
                "default": next((one.default for one in group if one.default is not None), None),
                "type": next((one.type for one in group if one.type), None),
                "package": owner.package,
                "node": owner.node,
                "node_iri": self.node(owner),
                "accesses": accesses(group),
                "evidence": self._where.evidence(owner.repository, group[0].location),
                "calls": [self._where.evidence(owner.repository, one) for one in group[0].via],
            }
            for owner, facts in by_node.items()
            for group in parameter_groups(facts)
        ]

    def defaults(
        self,
        code: Mapping[str, tuple[NodeReference, Parameter]],
        set_values: Sequence[SetParameter],
        instances: Collection[str] | None,
    ) -> list[SetParameter]:
        """Return the defaults in force: at starts of nodes that declare the parameter with one and do not set it.

        The value is unknown where the start loads an unknown parameter file. With `instances` only nodes of these names
        are looked at.
        """
        by_type = {
            self.node(owner): fact
            for owner, fact in code.values()
            if fact.default is not None and fact.name and not is_partial(fact.name)
        }
        has = {one.start.iri for one in set_values if one.start}
        unset = [one for one in starts(self._snapshot, set(by_type), instances) if one.iri not in has]
        files = unknown_files(self._snapshot, unset)
        defaults = []
        for one in unset:
            fact = by_type[one.type or ""]
            name = (fact.name or "").removeprefix("~/")
            absolute = f"{one.name}/{name}"
            default = SetParameter(name, absolute, fact.default, None, None, one.system, one, None)
            file = files.get(one.iri)
            defaults.append(replace(file, name=name, absolute=absolute) if file else default)
        return defaults

    def values(self, set_values: Sequence[SetParameter]) -> list[dict[str, Any]]:
        """Return one row for each thing, with all the launch files that have it; without rows of no launch file."""
        folded_rows: dict[str, dict[str, Any]] = {}
        names = system_names(self._snapshot, {one.system for one in set_values})
        systems = {self._iris.configuration(one.repository, one.path): one for one in names}
        for one in set_values:
            system = systems.get(one.system)
            if system is None or (self._chosen is not None and one.system not in self._chosen):
                continue
            source = system.repository
            row = {
                "instance": one.start.name if one.start else None,
                "parameter": one.absolute,
                "value": one.value,
                "reason": one.reason,
                "set_at": self._where.evidence(source, one.location) if one.location else None,
                "launched": self._where.evidence(source, one.start.location) if one.start else None,
            }
            folded = folded_rows.setdefault(repr(row), {**row, "systems": []})
            folded["systems"] = sorted({*folded["systems"], system.name})
        return sorted(
            folded_rows.values(), key=lambda one: (one["parameter"], one["set_at"] is None, -len(one["systems"]))
        )

    def node(self, owner: NodeReference) -> str:
        """Return the IRI of a node type."""
        return self._iris.node(owner.repository, owner.package, owner.node)
