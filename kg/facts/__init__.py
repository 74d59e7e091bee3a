"""The facts that pass from reading to the graph, and nothing else does; all are frozen and slotted.

Paths are relative to the root of their source, with `/` between parts; lines count from one. A fact never holds an
IRI: `kg.graph` makes those.

Two levels are never mixed (see `docs/names.md`): a `NodeType` (`kg.facts.code`) is what code declares, names as
written; a `NodeInstance` (`kg.facts.systems`) is one start of it by a launch configuration (`kg.facts.launch`), with
the names that namespaces, remappings and parameters give it.
"""

from __future__ import annotations

from kg.facts.code import (
    TREE_NODE,
    Access,
    Bound,
    DataFile,
    Dependency,
    Field,
    FileKind,
    Interface,
    InterfaceDefinition,
    NodeKind,
    NodeType,
    Package,
    PackageFacts,
    Parameter,
    Person,
    PluginDefault,
    PluginSlot,
    Problem,
    Qos,
    Repository,
    Resolution,
    Role,
    SourceFile,
)
from kg.facts.launch import (
    LaunchArgument,
    LaunchConfiguration,
    LaunchDialect,
    LaunchInclude,
    LaunchParameter,
    LaunchPlugin,
    LaunchProblem,
    LaunchProblemKind,
    PluginValue,
    Remap,
    StartedNode,
    StartKind,
)
from kg.facts.places import Location
from kg.facts.systems import (
    InstanceInterface,
    InstanceParameter,
    InstanceRemap,
    Known,
    MissingType,
    NodeInstance,
    NodeName,
    NodeReference,
    Sighting,
    System,
)
from kg.facts.texts import Description, DescriptionKind, Phrase, Snippet

__all__ = [
    "TREE_NODE",
    "Access",
    "Bound",
    "DataFile",
    "Dependency",
    "Description",
    "DescriptionKind",
    "Field",
    "FileKind",
    "InstanceInterface",
    "InstanceParameter",
    "InstanceRemap",
    "Interface",
    "InterfaceDefinition",
    "Known",
    "LaunchArgument",
    "LaunchConfiguration",
    "LaunchDialect",
    "LaunchInclude",
    "LaunchParameter",
    "LaunchPlugin",
    "LaunchProblem",
    "LaunchProblemKind",
    "Location",
    "MissingType",
    "NodeInstance",
    "NodeKind",
    "NodeName",
    "NodeReference",
    "NodeType",
    "Package",
    "PackageFacts",
    "Parameter",
    "Person",
    "Phrase",
    "PluginDefault",
    "PluginSlot",
    "PluginValue",
    "Problem",
    "Qos",
    "Remap",
    "Repository",
    "Resolution",
    "Role",
    "Sighting",
    "Snippet",
    "SourceFile",
    "StartKind",
    "StartedNode",
    "System",
]
