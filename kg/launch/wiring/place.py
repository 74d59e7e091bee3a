"""The name and namespace of an instance, against which the names that it uses are resolved.

Sources: wiki.ros.org/Names, and `rcl_expand_topic_name` of ROS 2. Parts that are not known stay holes.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache, lru_cache

from kg.facts import NodeType, StartedNode, StartKind
from kg.holes import ANONYMOUS, PARENT, substitute
from kg.launch.wiring.plugin_table import rows
from kg.launch.wiring.types import own_name
from kg.names import join, normalise


@dataclass(frozen=True, slots=True)
class Place:
    """Base of relative and private names.

    `namespace` and `name` are those of the node, `name` without namespace. `private` is what `~` stands for where that
    is not the node's name: plugins have a place of their own below it.
    """

    namespace: str
    name: str
    private: str | None = None

    @property
    def full(self) -> str:
        """The absolute name of the node."""
        return _resolved(self.name, self.namespace, "")

    def resolve(self, name: str) -> str:
        """Return the absolute name of a relative, private or absolute one."""
        return _resolved(name, self.namespace, self.private or self.full)

    def expand(self, name: str, ros: int) -> str:
        """Return what `resolve` does of a name with labels that mean the name and namespace of the node.

        In ROS 1 the name of a node is its absolute one.
        """
        own = {
            "node": self.full if ros == 1 else self.name,
            "ns": self.namespace,
            "namespace": self.namespace,
            PARENT: self.namespace.rpartition("/")[0],
        }
        return self.resolve(substitute(name, own.get))


@lru_cache(maxsize=16_384)
def _resolved(name: str, namespace: str, private: str) -> str:
    written = normalise(name)
    if written.startswith("/"):
        return written
    if written.startswith("~"):
        return normalise(f"{private}/{written[1:]}")
    return normalise(f"/{join(namespace, written)}")


@dataclass(frozen=True, slots=True)
class _Called:
    """A row of the table; its head explains the fields."""

    ros: int
    source: str
    program: tuple[str, ...]
    name: str


@cache
def _called() -> dict[str, str]:
    return {program: row.name for row in rows("called", _Called) for program in row.program}


def place_of(started: StartedNode, node: NodeType | None) -> Place:
    """Return the place of a started node.

    In ROS 2 a node keeps the name and the namespace that its code gives it, unless the launch file gives others; the
    name is that of the program where the type is not known. Rules for `__node`, `__name` and `__ns` count where the
    launch file gives nothing else.
    """
    rules = {rule.source: rule.target for rule in reversed(started.remaps) if rule.source.startswith("__")}
    name = started.name or rules.get("__node") or rules.get("__name")
    if not name and node is not None:
        name = own_name(node)
    elif not name:
        program = (started.executable or started.plugin or ANONYMOUS).replace("::", "/").rpartition("/")[2]
        name = _called().get(f"{started.package}/{program}") or program.removesuffix(".py") or ANONYMOUS
    namespace = normalise(f"/{started.namespace}")
    if namespace == "/" and "__ns" in rules:
        namespace = normalise(f"/{rules['__ns']}")
    inner, _, last = normalise(name).strip("~/").rpartition("/")
    if started.kind is StartKind.INNER and name.startswith("/"):  # the code gives this node a namespace
        return Place(normalise(f"/{inner}") if namespace == "/" else namespace, last)
    if namespace == "/" and node is not None and node.node_namespace is not None:
        namespace = node.node_namespace
    return Place(normalise(f"{namespace}/{inner}"), last or ANONYMOUS)
