"""The document of a node type: all data by which its hits are ranked and explained.

The structures are msgspec's, since they are kept as JSON in the store's cache and read back at each start.
"""

from __future__ import annotations

import msgspec


class Text(msgspec.Struct, array_like=True, frozen=True, gc=False):
    """A paragraph about a node or package, and where it is; `kind` is that of `kg.facts.DescriptionKind`."""

    text: str
    kind: str
    path: str
    line: int
    heading: str | None = None


class End(msgspec.Struct, array_like=True, frozen=True, gc=False):
    """An interface: `role` is a key of `kg nodes --json`, `name` as the node gives it to ROS, `type` `package/Type`."""

    role: str
    name: str | None
    type: str | None
    path: str
    line: int


class PackageDocument(msgspec.Struct, frozen=True, gc=False):
    """A package: what its nodes share. `licenses` are names as written and those of SPDX."""

    iri: str
    repository: str
    name: str
    version: str | None = None
    ros: int = 0
    path: str = ""
    deprecated: bool = False
    description: str | None = None
    licenses: tuple[str, ...] = ()
    texts: tuple[Text, ...] = ()
    copies: tuple[str, ...] = ()


class Document(msgspec.Struct, frozen=True, gc=False):
    """A node type; `package` is the place of its package in the list of packages.

    `hardware`, `functions` and `capabilities` are labels; `starts` is how often launch files start it.
    """

    iri: str
    name: str
    kind: str
    package: int
    ros: int
    path: str
    line: int
    executable: str | None = None
    plugin: str | None = None
    node_name: str | None = None
    aliases: tuple[str, ...] = ()
    texts: tuple[Text, ...] = ()
    ends: tuple[End, ...] = ()
    parameters: tuple[tuple[str, str | None], ...] = ()
    hardware: tuple[str, ...] = ()
    functions: tuple[str, ...] = ()
    capabilities: tuple[str, ...] = ()
    starts: int = 0
