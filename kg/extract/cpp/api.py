"""The shape of the tables of calls, and their union: what ROS 1 (`ros1`) and ROS 2 (`ros2`) know stands behind `Api`.

A table says which calls and which types make interfaces and parameters; the engine (`kg.extract.cpp.calls`)
finds their uses and reads them. What needs code rather than data, that is, how handles and parameters
evaluate, is a `Dialect` of each ROS.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Final, Protocol

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable

    from kg.extract.cpp.context import Context
    from kg.extract.cpp.evaluate import Alternatives, Evaluator
    from kg.extract.cpp.syntax import Callee
    from kg.extract.cpp.types import TypeName
    from kg.extract.cpp.unit import Class, Expr
    from kg.facts import Access, Qos, Role

__all__ = ["ARGUMENT_LISTS", "Api", "CallSpec", "Dialect", "MarkSpec", "ParameterSpec", "TypeSpec"]

ARGUMENT_LISTS: Final = {"removeROSArgs": 2}
"""Functions that leave the arguments of the program (their second argument) in the argument of this index."""


@dataclass(frozen=True, slots=True)
class CallSpec:
    """A call that makes an interface; `ros` is 0 for libraries that both versions have alike.

    `name` is the index of the argument with the name and `handle` that of the argument with the node or node
    handle, None where that is the receiver. `receivers` are the names of the types whose method it is, empty
    for free functions, whose last namespace `scopes` lists (empty: any). The type of the interface comes from
    the `template` argument of that index, else from the parameter of the `callback` argument, else from the
    type of the argument `typed`, else from the text of the argument `spelled`, else it is `fixed`.
    `least` and `most` bound the number of arguments. `qos` is the index of the quality of service.
    `camera` says that `camera_info` is made beside it, `mark` which framework it uses; `inherited` that a
    class calls it as a method that it inherits, `explicit` that it needs a template argument to be meant.
    With `exact` a receiver whose type is not known does not do.
    With `options` the call fills an object that a call of a handle takes (`kg.extract.cpp.options`).
    With `specified`, the template argument of that index (or the one of the type of the argument 0 where the call has
    none) is a class that holds name and type of the interface, as `autoware_component_interface_specs` has them.
    """

    ros: int
    role: Role
    name: int = 0
    handle: int | None = None
    receivers: frozenset[str] = frozenset()
    scopes: frozenset[str] = frozenset()
    template: int | None = None
    callback: int | None = None
    typed: int | None = None
    spelled: int | None = None
    fixed: str | None = None
    least: int = 1
    most: int = 9
    qos: int | None = None
    camera: bool = False
    mark: str | None = None
    inherited: bool = False
    service: bool = False
    receiver_template: bool = False
    explicit: bool = False
    specified: bool = False
    usual: Qos | None = None
    """The quality of service where the call does not give one."""
    options: bool = False
    exact: bool = False


@dataclass(frozen=True, slots=True)
class TypeSpec:
    """A type whose objects are interfaces when they are constructed; indices as in `CallSpec`.

    When the first argument is no handle and `floating` is set, the handle was left out and all indices after
    it move down by one. `scopes` are the namespaces that the type may stand in, empty for any.
    """

    ros: int
    role: Role | None
    handle: int | None = 0
    name: int = 1
    template: int | None = 0
    fixed: str | None = None
    constants: tuple[tuple[str, str], ...] = ()
    """Pairs of name and type where one object makes several interfaces of its own naming."""
    floating: bool = False
    scopes: frozenset[str] = frozenset()
    mark: str | None = None
    qos: int | None = None
    usual: Qos | None = None
    camera: bool = False
    drop: str = ""
    private: bool = False
    """A handle that was left out means the private namespace."""


@dataclass(frozen=True, slots=True)
class MarkSpec:
    """A type whose mere use is a mark; `handle` is the argument with the namespace, `detail` the one with a text."""

    key: str
    handle: int | None = None
    detail: int | None = None
    template: int | None = None


@dataclass(frozen=True, slots=True)
class ParameterSpec:
    """A call that reads, writes or declares a parameter.

    `output` is the argument that the value is written to, `default` the one with the default; `returns` tells
    whether the call is the value. `scopes` are as in `CallSpec`; where empty the call is a method of a handle.
    `listed` says that the argument `name` holds many: names, or pairs of name and default, below the prefix that the
    argument `default` is. A `helper` is a free function around such a method, in whatever namespace, that is taken
    for the method itself.
    """

    ros: int
    access: Access
    name: int = 0
    output: int | None = None
    default: int | None = None
    returns: bool = False
    scopes: frozenset[str] = frozenset()
    least: int = 1
    most: int = 6
    receivers: frozenset[str] = frozenset()
    helper: bool = False
    handle: int | None = None
    """The argument with the node handle, where that is not the receiver."""
    listed: bool = False
    single: bool = False
    """The argument `name` is one such pair and not a list of them."""


class Dialect(Protocol):
    """What one ROS makes of handles, parameters and nodes."""

    calls: dict[str, tuple[CallSpec, ...]]
    types: dict[str, TypeSpec]
    parameters: dict[str, tuple[ParameterSpec, ...]]
    marks: dict[str, MarkSpec]
    handles: frozenset[str]
    given_members: dict[str, dict[str, str]]
    """Members that classes outside of the build hand down: handles by base class and name, as namespaces."""
    given_arguments: dict[tuple[str, int], dict[int, str]]
    """Arguments that frameworks call a method of a plugin with: handles by method, number of parameters and place."""
    wrappers: frozenset[str]
    """Classes of widely used packages that tables stand for; they are not entered even where the build has them."""

    def evaluate(
        self, evaluator: Evaluator, where: Expr, called: Callee, given: list[Expr], context: Context
    ) -> Alternatives | None:
        """Return what a call that makes a handle or reads a parameter is; None for other calls."""

    def construct(
        self, evaluator: Evaluator, kind: TypeName, given: list[Expr], context: Context
    ) -> Alternatives | None:
        """Return what an object of one of its types is; None for other types."""

    def output(  # noqa: PLR0913, PLR0917 - the whole of a call and its place
        self,
        evaluator: Evaluator,
        where: Expr,
        called: Callee,
        given: list[Expr],
        index: int,
        context: Context,
        previous: Callable[[Context], Alternatives],
    ) -> Alternatives | None:
        """Return what a call leaves in its `index`-th argument; None for calls not of this table."""

    def is_node(self, evaluator: Evaluator, cls: Class) -> bool:
        """Tell whether objects of a class are nodes."""


class Api:
    """The union of dialects."""

    def __init__(self, dialects: Iterable[Dialect]) -> None:
        self.dialects = tuple(dialects)
        self.calls: dict[str, tuple[CallSpec, ...]] = {}
        self.types: dict[str, list[TypeSpec]] = {}
        self.parameters: dict[str, tuple[ParameterSpec, ...]] = {}
        self.marks: dict[str, MarkSpec] = {}
        for dialect in self.dialects:
            for name, calls in dialect.calls.items():
                self.calls[name] = (*self.calls.get(name, ()), *calls)
            for name, kind in dialect.types.items():
                self.types.setdefault(name, []).append(kind)
            for name, parameters in dialect.parameters.items():
                self.parameters[name] = (*self.parameters.get(name, ()), *parameters)
            self.marks.update(dialect.marks)
        self.handles = frozenset().union(*(dialect.handles for dialect in self.dialects))
        self.helpers = frozenset(name for name, specs in self.parameters.items() if any(spec.helper for spec in specs))
        self.wrappers = frozenset().union(*(dialect.wrappers for dialect in self.dialects))
        self.closed = self.wrappers | frozenset(self.types) | frozenset(self.marks) | self.handles

    def evaluate(
        self, evaluator: Evaluator, where: Expr, called: Callee, given: list[Expr], context: Context
    ) -> Alternatives | None:
        """See `Dialect.evaluate`."""
        for dialect in self.dialects:
            found = dialect.evaluate(evaluator, where, called, given, context)
            if found is not None:
                return found
        return None

    def construct(
        self, evaluator: Evaluator, kind: TypeName, given: list[Expr], context: Context
    ) -> Alternatives | None:
        """See `Dialect.construct`."""
        for dialect in self.dialects:
            found = dialect.construct(evaluator, kind, given, context)
            if found is not None:
                return found
        return None

    def output(  # noqa: PLR0913, PLR0917 - the whole of a call and its place
        self,
        evaluator: Evaluator,
        where: Expr,
        called: Callee,
        given: list[Expr],
        index: int,
        context: Context,
        previous: Callable[[Context], Alternatives],
    ) -> Alternatives | None:
        """See `Dialect.output`."""
        for dialect in self.dialects:
            found = dialect.output(evaluator, where, called, given, index, context, previous)
            if found is not None:
                return found
        return None

    def given_member(self, bases: Iterable[str], name: str) -> str | None:
        """Return the namespace of the handle that a base class outside of the build hands down as member `name`."""
        tables = [dialect.given_members for dialect in self.dialects]
        return next((table[base][name] for base in bases for table in tables if name in table.get(base, ())), None)

    def given_argument(self, method: str, count: int, index: int) -> str | None:
        """Return the namespace of the handle that a framework calls a method of a plugin with."""
        tables = [dialect.given_arguments for dialect in self.dialects]
        return next((table[method, count][index] for table in tables if index in table.get((method, count), ())), None)

    def is_node(self, evaluator: Evaluator, cls: Class) -> bool:
        """See `Dialect.is_node`."""
        return any(dialect.is_node(evaluator, cls) for dialect in self.dialects)
