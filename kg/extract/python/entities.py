"""What a Python expression can be besides the values that languages share (`kg.extract.values`).

`Frame` is one way in which a scope is run: a call with its arguments, left unevaluated until needed. Two
calls of one function are two frames, so that the arguments of one call are never mixed with those of another.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING, TypeAlias

from kg.extract.values import Number, Text, Truth, Unknown

if TYPE_CHECKING:
    from tree_sitter import Node

    from kg.extract.python.unit import Scope, Unit
    from kg.facts import Qos

__all__ = [
    "Alternatives",
    "ArgumentsParsed",
    "Bound",
    "Choice",
    "ClassRef",
    "Dotted",
    "Frame",
    "FunctionRef",
    "Instance",
    "Items",
    "Made",
    "ModuleRef",
    "Nothing",
    "ParameterRead",
    "QosValue",
    "Super",
    "Table",
    "Thing",
    "Thunk",
    "plain",
]


@dataclass(frozen=True, slots=True)
class Dotted:
    """Something outside of the build, by its full name: `rospy.Publisher`, `std_msgs.msg.String`, `builtins.len`."""

    path: str


@dataclass(frozen=True, slots=True)
class ModuleRef:
    """A module of the build."""

    unit: Unit


@dataclass(frozen=True, slots=True)
class ClassRef:
    """A class of the build."""

    scope: Scope


@dataclass(frozen=True, slots=True)
class FunctionRef:
    """A function of the build, with the object that it is bound to and the frame that it was defined in."""

    scope: Scope
    lexical: Frame
    instance: Instance | None = None


@dataclass(slots=True, eq=False)
class Instance:
    """An object of a class of the build; `frame` is the run of its `__init__` (or of the class's base outside)."""

    klass: Scope
    call: Node | None
    caller: Frame | None
    frame: Frame | None = None


@dataclass(frozen=True, slots=True)
class Made:
    """What a call of something outside of the build gives; `call` and `frame` hold the arguments."""

    path: str
    call: Node
    frame: Frame


@dataclass(frozen=True, slots=True)
class Bound:
    """A method of something outside of the build, with its object (None where the object is not known)."""

    path: str
    receiver: Thing | None


@dataclass(frozen=True, slots=True)
class Super:
    """`super()`: the object, seen as a class behind `after` in its lineage."""

    instance: Instance
    after: Scope


@dataclass(frozen=True, slots=True)
class ParameterRead:
    """A ROS 2 parameter object: `value` is what `.value` gives."""

    value: Thing


@dataclass(frozen=True, slots=True)
class ArgumentsParsed:
    """The result of `parse_args` of argparse or optparse in a file."""

    unit: Unit


@dataclass(frozen=True, slots=True)
class QosValue:
    """A quality of service of ROS 2."""

    qos: Qos


@dataclass(frozen=True, slots=True)
class Nothing:
    """`None`."""


@dataclass(frozen=True, slots=True)
class Items:
    """A list, tuple or set."""

    items: tuple[Thing, ...]


@dataclass(frozen=True, slots=True)
class Table:
    """A dictionary, in order."""

    items: tuple[tuple[Thing, Thing], ...]

    def get(self, key: Thing) -> Thing | None:
        """Return the value of a key that is known."""
        wanted = plain(key)
        return next((value for known, value in self.items if wanted is not None and plain(known) == wanted), None)


Thing: TypeAlias = (
    "Text | Number | Truth | Unknown | Dotted | ModuleRef | ClassRef | FunctionRef | Instance | Made | Bound"
    " | ParameterRead | Super | ArgumentsParsed | QosValue | Nothing | Items | Table"
)

Choice: TypeAlias = "dict[tuple[int, int], int]"
"""What was chosen so far: for a frame's id and the start of an `if`, `except` or `for`, the branch or round."""

Alternatives: TypeAlias = "list[tuple[Thing, Choice]]"


@dataclass(frozen=True, slots=True)
class Thunk:
    """An expression with the frame to evaluate it in, or a value that is known already."""

    node: Node | None
    frame: Frame | None
    value: Thing | None = None


@dataclass(slots=True, eq=False)
class Frame:
    """One run of a scope. `open` when the caller is not known; `arms` are the branches around the call."""

    id: int
    scope: Scope
    arguments: dict[str, Thunk] = field(default_factory=dict)
    rest: tuple[Thunk, ...] = ()
    keywords: dict[str, Thunk] = field(default_factory=dict)
    instance: Instance | None = None
    lexical: Frame | None = None
    caller: Frame | None = None
    open: bool = False
    depth: int = 0
    choice: Choice = field(default_factory=dict)


def plain(value: Thing) -> str | float | bool | None:
    """Return the Python value of a text, number or truth that is known, for comparisons."""
    if isinstance(value, Text):
        return value.known
    if isinstance(value, Number | Truth):
        return value.value
    return None
