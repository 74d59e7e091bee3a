"""Document of a node type: the data that ranks and explains its hits.

The structures are msgspec's, because they are stored as JSON in the store's cache and decoded at each start.
"""

from __future__ import annotations

import msgspec


class Text(msgspec.Struct, array_like=True, frozen=True, gc=False):
    """A paragraph about a node or package, with its place; `kind` is that of `kg.facts.DescriptionKind`."""

    text: str
    kind: str
    path: str
    line: int
    heading: str | None = None


class End(msgspec.Struct, array_like=True, frozen=True, gc=False):
    """An interface: `role` is a key of `kg nodes --json`, `name` the name passed to ROS, `type` is `package/Type`."""

    role: str
    name: str | None
    type: str | None
    path: str
    line: int


class PackageDocument(msgspec.Struct, frozen=True, gc=False):
    """A package: the data shared by its nodes. `licenses` contains names as written and SPDX names.

    `texts` contains the usage sections of its README only if it has few nodes (`rnkg:speaksFor`).
    """

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
    """A node type; `package` is the index of its package in the list of packages.

    `hardware`, `functions` and `capabilities` are labels; `starts` is the number of its starts in launch files.
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
