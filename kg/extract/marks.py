"""What a reader of code hands on beside a node: which frameworks the node uses, and where.

A framework makes interfaces that do not stand in the code (`/rosout`, `/tf`, a bond, `~/set_parameters`).
The readers of C++ and Python only mark the use; `kg.extract.implicit` turns marks into implicit interfaces
with the table `ontology/implicit.toml`, whose keys the marks are.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from kg.facts import Location, NodeType

__all__ = ["Extracted", "Mark"]


@dataclass(frozen=True, slots=True)
class Mark:
    """One use of a framework by a node.

    `key` is an entry of the table (`ros1.node`, `tf.listener`, `dynamic_reconfigure.server`,
    `image_transport.publisher`). `name` is the name that the interfaces hang on where the framework derives
    them from one (the topic of an image publisher, the namespace of a reconfigure server), written like
    `Interface.name`. `argument` is a further word the table may need: the configuration type of a
    reconfigure server (`package/Name`), say.
    """

    key: str
    location: Location
    name: str | None = None
    argument: str | None = None


@dataclass(frozen=True, slots=True)
class Extracted:
    """A node as its code declares it, with the marks of the frameworks it uses."""

    node: NodeType
    marks: tuple[Mark, ...] = ()
