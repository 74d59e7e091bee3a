"""One launch configuration, wired: the view `system`."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from kg.facts import Location
from kg.graph.iris import Iris
from kg.graph.systems_reading import systems as read_systems
from kg.holes import is_known
from kg.render.system_graph import instance_keys, system_graph
from kg.views.evidence import places
from kg.views.lint import finding_objects, system_report
from kg.views.remembered import while_last
from kg.views.system_picture import picture
from kg.views.system_rows import instance_rows, setting_row
from kg.views.systems import known_names, system_named

if TYPE_CHECKING:
    from collections.abc import Iterable

    from kg.facts import LaunchArgument, LaunchInclude, LaunchProblem, System
    from kg.graph.systems_reading import SystemName
    from kg.settings import Settings
    from kg.store.snapshot import EmbeddedSnapshot
    from kg.views.evidence import Places

__all__ = ["system"]


def system(
    snapshot: EmbeddedSnapshot, settings: Settings, *, name: str, repository: str = "", every: str = ""
) -> dict[str, Any]:
    """Return the computation graph of a launch configuration, with its findings.

    `name` is its name, the end of it by whole segments, or its IRI; `repository` distinguishes several of one name.
    With `every` (any text) the table has what frameworks make, too. The keys:

    * `name`, `iri`, `repository`, `path`, `package`, `ros`, `dialect`, `evidence` (the launch file), `arguments`
      (`name`, `default`, `value`, `description`, `fixed`, `choices`, `evidence`), `includes` (`name`, `iri`, `path`),
      `settings` (parameters that are no instance's), `problems` (`kind`, `message`, `subject`, `evidence`).
    * `instances`: what is started, see `kg.views.system_rows`; with their ends this is the table of the system.
    * `picture`: the same as a graph, see `kg.views.system_picture`.
    * `findings` and `allowed`: as the view `lint` has them.
    * `counts`: of `nodes`, `topics`, `services`, `actions`, `unresolved` (ends whose name is not known).

    Raises:
        UnknownNameError: KG422 with suggestions if there is none.
        UsageError: KG003 if there are several.
    """
    meant = system_named(snapshot, name, repository, settings.base)
    found = _read(snapshot, meant, settings.base)
    where, iris, source = places(snapshot), Iris(settings.base), meant.repository
    report = system_report(snapshot, settings, meant)
    graph, own = system_graph(found, every=True), found.configuration
    keys = instance_keys(found.instances)
    unresolved = sum(not is_known(end.resolved) for one in keys.values() for end in one.interfaces)
    kinds = [channel.kind for channel in graph.channels if not channel.open]
    return {
        "name": meant.name,
        "iri": iris.configuration(source, meant.path),
        "repository": source,
        "path": meant.path,
        "package": own.package,
        "ros": meant.ros,
        "dialect": str(own.dialect),
        "evidence": where.evidence(source, Location(meant.path, 0)),
        "arguments": [_argument(one, source, where) for one in own.arguments],
        "includes": _includes(own.includes, snapshot, iris),
        "settings": [setting_row(one, source, where) for one in found.shared_parameters],
        "problems": [_problem(one, source, where) for one in own.problems],
        "instances": instance_rows(found, keys, graph, where, iris, every=bool(every)),
        "picture": picture(graph, keys, report.findings, iris),
        "findings": finding_objects(report.findings, where),
        "allowed": len(report.allowed),
        "counts": {
            "nodes": len(found.instances),
            **{f"{kind}s": kinds.count(kind) for kind in ("topic", "service", "action")},
            "unresolved": unresolved,
        },
    }


@while_last
def _read(snapshot: EmbeddedSnapshot, name: SystemName, base: str) -> System:
    """Read a system, the parts of whose page may each ask for it."""
    (found,) = read_systems(snapshot, [name], base)
    return found


def _argument(one: LaunchArgument, source: str, where: Places) -> dict[str, Any]:
    return {
        "name": one.name,
        "default": one.default,
        "value": one.value,
        "description": one.description,
        "fixed": one.fixed,
        "choices": list(one.choices),
        "evidence": where.evidence(source, one.location),
    }


def _includes(those: Iterable[LaunchInclude], snapshot: EmbeddedSnapshot, iris: Iris) -> list[dict[str, Any]]:
    named = {(other.repository, other.path): other.name for other in known_names(snapshot)}
    found = [(one.repository or "", one.path or one.written) for one in those]
    return [
        {"name": named.get((repository, path), path), "iri": iris.configuration(repository, path), "path": path}
        for repository, path in found
    ]


def _problem(one: LaunchProblem, source: str, where: Places) -> dict[str, Any]:
    return {
        "kind": str(one.kind),
        "message": one.message,
        "subject": one.subject,
        "evidence": where.evidence(source, one.location),
    }
