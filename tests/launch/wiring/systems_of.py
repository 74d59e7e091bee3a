"""Systems for tests: a TOML file has the started nodes, the node types, and the expected result."""

from __future__ import annotations

import tomllib
from typing import TYPE_CHECKING, Any

import yaml

from kg.facts import (
    Access,
    DataFile,
    InstanceInterface,
    Interface,
    LaunchConfiguration,
    LaunchDialect,
    LaunchParameter,
    Location,
    NodeKind,
    NodeReference,
    NodeType,
    Parameter,
    PluginDefault,
    PluginSlot,
    Qos,
    Remap,
    Resolution,
    Role,
    StartedNode,
    StartKind,
    System,
)
from kg.launch.wiring.systems import wire
from kg.launch.wiring.types import NodeTypes

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping
    from pathlib import Path

__all__ = ["configuration", "node_type", "read_case", "reference", "seen", "started"]

HERE = "local/here"
_LINE = Location("demo/launch/x.launch", 1)


def reference(row: Mapping[str, Any]) -> NodeReference:
    """Return the reference of a node type of a case."""
    return NodeReference(row.get("repository", HERE), row["package"], row["name"])


def node_type(row: Mapping[str, Any], ros: int) -> NodeType:
    """Return the node type of a row; interfaces are names, or tables of non-default fields."""
    interfaces = [_interface(role, one) for role in Role for one in row.get(role.value, ())]
    return NodeType(
        name=row["name"],
        kind=NodeKind(row.get("kind", "executable")),
        language=row.get("language", "cpp"),
        ros=ros,
        location=Location("src/x.cpp", 1),
        executable=row.get("executable"),
        plugin=row.get("plugin"),
        node_name=row.get("node_name"),
        node_namespace=row.get("node_namespace"),
        base_class=row.get("base_class"),
        aliases=tuple(row.get("aliases", ())),
        interfaces=tuple(interfaces),
        parameters=tuple(_parameter(one) for one in row.get("parameters", ())),
        slots=tuple(_slot(one) for one in row.get("slots", ())),
    )


def _slot(one: str | Mapping[str, Any]) -> PluginSlot:
    row: dict[str, Any] = {"base": one} if isinstance(one, str) else dict(one)
    defaults = tuple(PluginDefault(kind, name) for name, kind in row.get("defaults", {}).items())
    return PluginSlot(row["base"], Location("src/x.cpp", 3), row.get("names"), row.get("parameter"), defaults)


def _interface(role: Role, one: str | Mapping[str, Any]) -> Interface:
    row: dict[str, Any] = {"name": one} if isinstance(one, str) else dict(one)
    name = row.get("name")
    usual = "unresolved" if name is None else "partial" if "{}" in name else "literal"
    if name is not None and row.get("parameter"):
        usual = "parameter-default"
    return Interface(
        role=role,
        name=name,
        type=row.get("type"),
        resolution=Resolution(row.get("resolution", usual)),
        location=Location(row.get("path", "src/x.cpp"), row.get("line", 1)),
        written=row.get("written"),
        parameter=row.get("parameter"),
        implicit=row.get("implicit", False),
        origin=row.get("origin"),
        qos=Qos(**row["qos"]) if "qos" in row else None,
        reason=row.get("reason"),
        arguments=row.get("arguments", 0),
        switches=tuple(row.get("switches", ())),
        via=tuple(Location(path, 1) for path in row.get("via", ())),
        node=row.get("node"),
    )


def _parameter(one: str | Mapping[str, Any]) -> Parameter:
    row: dict[str, Any] = {"name": one} if isinstance(one, str) else dict(one)
    access = Access(row.get("access", "read"))
    return Parameter(row["name"], None, row.get("default"), access, Location("src/x.cpp", 2))


def _given(name: str, value: object) -> LaunchParameter:
    text = None if value == "?" else yaml.safe_dump(value, default_flow_style=True, width=10_000).strip()
    node, _, name = name.rpartition(":")
    return LaunchParameter(name, text.removesuffix("\n...") if text is not None else None, _LINE, node=node or None)


def started(row: Mapping[str, Any]) -> StartedNode:
    """Return the started node of a row."""
    return StartedNode(
        name=row.get("name"),
        namespace=row.get("namespace", "/"),
        kind=StartKind(row.get("kind", "node")),
        location=_LINE,
        package=row.get("package"),
        executable=row.get("executable"),
        plugin=row.get("plugin"),
        host=row.get("host"),
        remaps=tuple(
            Remap(source, target, Location(_LINE.path, 10 + n))
            for n, (source, target) in enumerate(row.get("remaps", ()))
        ),
        parameters=tuple(_given(name, value) for name, value in row.get("parameters", {}).items()),
        arguments=tuple(row.get("arguments", ())),
    )


def configuration(
    nodes: Iterable[StartedNode], ros: int, parameters: Mapping[str, object] | None = None
) -> LaunchConfiguration:
    """Return a configuration that starts nodes, with the parameters of ROS 1."""
    dialect = LaunchDialect.ROSLAUNCH if ros == 1 else LaunchDialect.ROS2_PYTHON
    return LaunchConfiguration(
        repository=HERE,
        package="demo",
        path="demo/launch/x.launch",
        ros=ros,
        dialect=dialect,
        nodes=tuple(nodes),
        parameters=tuple(_given(name, value) for name, value in (parameters or {}).items()),
    )


def read_case(path: Path) -> tuple[System, dict[str, Any]]:
    """Return the wired system of a case, and its expected result."""
    case = tomllib.loads(path.read_text("utf-8"))
    data = [DataFile(HERE, row["package"], row["path"], row["text"]) for row in case.get("data", ())]
    types = NodeTypes([(reference(row), node_type(row, case["ros"])) for row in case.get("type", ())], data=data)
    nodes = [started(row) for row in case["node"]]
    return wire(configuration(nodes, case["ros"], case.get("parameters")), types), case["expected"]


def seen(system: System) -> dict[str, Any]:
    """Return a system in the notation of the cases, without empty fields and defaults."""
    view: dict[str, Any] = {
        instance.name: _without_empty(
            {
                "type": str(instance.type).partition(":")[2] if instance.type else "",
                "missing": instance.missing.value if instance.missing else "",
                "reason": instance.reason or "",
                "like": list(instance.similar),
                "plugins": [str(plugin).partition(":")[2] for plugin in instance.plugins],
                "ends": [
                    " ".join((end.declared.role.value, end.resolved or "?", end.resolution.value, *end.switches))
                    for end in instance.interfaces
                ],
                "remapped": [end.resolved for end in instance.interfaces if end.remap is not None],
                "set": [end.resolved or "?" for end in instance.interfaces if end.parameter is not None],
                "doubts": [end.reason for end in instance.interfaces if end.reason and _is_default(end)],
                "qos": [f"{end.qos.reliability} {end.qos.depth}" for end in instance.interfaces if end.qos is not None],
                "unused": [f"{rule.source} {rule.target}" for rule in instance.remaps if not rule.used],
                "meant": [name for rule in instance.remaps for name in rule.similar],
                "unknown": [" ".join((one.name, *one.similar)) for one in instance.parameters if one.declared is None],
                "complete": instance.complete,
            }
        )
        for instance in system.instances
    }
    if system.similar:
        view["similar"] = [" ".join(pair) for pair in system.similar]
    if system.shared_parameters:
        view["shared"] = [parameter.name for parameter in system.shared_parameters]
    return view


def _without_empty(row: dict[str, Any]) -> dict[str, Any]:
    return {key: value for key, value in row.items() if value not in ("", [], False)}


def _is_default(end: InstanceInterface) -> bool:
    return end.resolution is Resolution.PARAMETER_DEFAULT
