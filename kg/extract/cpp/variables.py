"""What is written to a variable or member, and where: declarations, assignments, initialisers, output arguments.

Writes are found by searching for the name and looking at what stands around it; no table of symbols is
made for code that nobody asks about.
"""

from __future__ import annotations

from dataclasses import dataclass
from enum import Enum, auto
from typing import TYPE_CHECKING, Final

from kg.extract.cpp import syntax
from kg.extract.cpp.unit import Expr

if TYPE_CHECKING:
    from collections.abc import Iterator

    from tree_sitter import Node

    from kg.extract.cpp.unit import Unit

__all__ = ["Write", "WriteKind", "writes"]


class WriteKind(Enum):
    """How a variable gets a value."""

    VALUE = auto()
    """`= value`, also from a declaration."""
    CONSTRUCT = auto()
    """`Type name(arguments)`, `name(arguments)` in an initialiser list, `name{...}`."""
    DECLARE = auto()
    """A declaration without a value."""
    APPEND = auto()
    """`+= value`, `append(value)`, `<< value`."""
    OUTPUT = auto()
    """Handed to a call that may write it, as `index`-th argument."""
    ELEMENT = auto()
    """An element of the range of a loop; `index` counts the names of a structured binding from 0, else is -1."""
    INSERT = auto()
    """`push_back(value)`, `[key] = value`."""
    READ = auto()
    """`stream >> name`."""
    COUNT = auto()
    """`++name` or `name++` in a loop, which `within` is."""
    PARAMETER = auto()
    """A parameter of a function or lambda."""


@dataclass(frozen=True, slots=True, eq=False)
class Write:
    """One write; `node` is the value, the call, the range or the declaration, by kind; `end` its last byte.

    `within` is the range of bytes that the write always happens in when it is entered. `owner` is the object
    whose member is written, None for a plain name or `this->name`; `type` the declared type.
    """

    kind: WriteKind
    unit: Unit
    name: Node
    node: Node
    end: int
    within: tuple[int, int]
    index: int = -1
    owner: Node | None = None
    type: Node | None = None

    @property
    def value(self) -> Expr:
        """The value as an expression."""
        return Expr.of(self.unit, self.node)


_APPENDING: Final = frozenset({"append", "concat"})
_INSERTING: Final = frozenset({"push_back", "emplace_back", "insert", "emplace", "push"})
_SETTING: Final = frozenset({"reset", "assign", "str"})
_BRANCHES: Final = frozenset(
    {
        "if_statement",
        "else_clause",
        "for_statement",
        "for_range_loop",
        "while_statement",
        "case_statement",
        "catch_clause",
        "compound_statement",
        "lambda_expression",
        "function_definition",
        "conditional_expression",
    }
)
_LOOPS: Final = frozenset({"for_statement", "for_range_loop", "while_statement", "do_statement"})
_TARGETS: Final = frozenset({"pointer_expression", "parenthesized_expression"})


def writes(unit: Unit, name: str, start: int, end: int) -> Iterator[Write]:
    """Yield the writes to `name` between two bytes of a unit, in order."""
    known = unit.memory.get(("writes", name))
    if known is None:
        found = (_write(unit, node) for node in unit.occurrences(name))
        known = unit.memory[("writes", name)] = [write for write in found if write is not None]
    return (write for write in known if start <= write.name.start_byte < end)


def _write(unit: Unit, node: Node) -> Write | None:
    parent, target, owner = node.parent, node, None
    if parent is not None and parent.type == "field_expression":
        field, holder = parent.child_by_field_name("field"), parent.child_by_field_name("argument")
        if field is not None and field.id == node.id:
            owner = None if holder is None or holder.type == "this" else holder
            target, parent = parent, parent.parent
    while parent is not None and parent.type in _TARGETS:
        target, parent = parent, parent.parent
    if parent is None:
        return None
    found = _by_parent(unit, node, target, parent)
    if found is None:
        return None
    kind, value, index, declared = found
    within = (value.start_byte, value.end_byte) if kind is WriteKind.COUNT else _extent(value)
    return Write(kind, unit, node, value, value.end_byte, within, index, owner, declared)


_Found = tuple[WriteKind, "Node", int, "Node | None"]


def _by_parent(unit: Unit, name: Node, target: Node, parent: Node) -> _Found | None:
    kind = parent.type
    if kind == "assignment_expression":
        return _assigned(target, parent)
    if kind == "field_initializer":
        return (WriteKind.CONSTRUCT, parent.named_children[-1], -1, None)
    if kind == "argument_list":
        given = [argument.id for argument in syntax.arguments(parent)]
        call = parent.parent
        if call is not None and call.type == "call_expression" and target.id in given:
            return (WriteKind.OUTPUT, call, given.index(target.id), None)
        return None
    if kind == "field_expression":
        return _by_method(parent)
    if kind == "subscript_expression":
        outer = parent.parent
        left = outer.child_by_field_name("left") if outer is not None else None
        if outer is not None and left is not None and left.id == parent.id and outer.type == "assignment_expression":
            return (WriteKind.INSERT, outer, -1, None)
        return None
    if kind == "binary_expression":
        return _streamed(target, parent)
    if kind == "update_expression":
        return _counted(name, parent)
    return _declared(unit, name)


def _counted(name: Node, parent: Node) -> _Found | None:
    """Return the loop that counts a variable on; None where there is none, or its head tells from where it counts."""
    inner = parent
    for outer in syntax.outward(parent):
        if outer.type in _LOOPS:
            update, first = outer.child_by_field_name("update"), outer.child_by_field_name("initializer")
            head = update is not None and update.id == inner.id
            told = head and first is not None and syntax.text(name) in syntax.text(first)
            return None if told else (WriteKind.COUNT, outer, -1, None)
        if outer.type in ("function_definition", "lambda_expression"):
            return None
        inner = outer
    return None


def _assigned(target: Node, parent: Node) -> _Found | None:
    left, right = parent.child_by_field_name("left"), parent.child_by_field_name("right")
    operator = parent.child_by_field_name("operator")
    if left is None or right is None or left.id != target.id:
        return None
    sign = syntax.text(operator) if operator is not None else "="
    if sign not in ("=", "+="):
        return None
    return (WriteKind.VALUE if sign == "=" else WriteKind.APPEND, right, -1, None)


def _by_method(parent: Node) -> _Found | None:
    call = parent.parent
    field = parent.child_by_field_name("field")
    if call is None or call.type != "call_expression" or field is None:
        return None
    method = syntax.simple_name(field)
    listed = call.child_by_field_name("arguments")
    if method == "clear" and listed is not None:
        return (WriteKind.CONSTRUCT, listed, -1, None)
    given = syntax.arguments(call.child_by_field_name("arguments"))
    if not given:
        return None
    if method in _APPENDING:
        return (WriteKind.APPEND, given[0], -1, None)
    if method in _INSERTING:
        return (WriteKind.INSERT, call, -1, None)
    return (WriteKind.VALUE, given[0], -1, None) if method in _SETTING else None


def _streamed(target: Node, parent: Node) -> _Found | None:
    """Return the stream that starts at a name: `stream << a << b`."""
    operator, left = parent.child_by_field_name("operator"), parent.child_by_field_name("left")
    if operator is not None and syntax.text(operator) == ">>" and (left is None or left.id != target.id):
        return (WriteKind.READ, target, -1, None)
    if operator is None or left is None or left.id != target.id or syntax.text(operator) != "<<":
        return None
    whole = parent
    for outer in syntax.outward(parent, 40):
        if outer.type != "binary_expression":
            break
        whole = outer
    return (WriteKind.APPEND, whole, -1, None)


def _declared(unit: Unit, name: Node) -> _Found | None:
    inner, index = name, -1
    for parent in syntax.outward(name, 12):
        kind = parent.type
        if kind == "init_declarator":
            return _initialised(inner, parent)
        if kind == "structured_binding_declarator":
            index = [child.id for child in parent.named_children].index(inner.id)
        elif kind == "for_range_loop":
            value = parent.child_by_field_name("right")
            declarator = parent.child_by_field_name("declarator")
            if value is None or declarator is None or declarator.id != inner.id:
                return None
            return (WriteKind.ELEMENT, value, index, parent.child_by_field_name("type"))
        elif kind in ("parameter_declaration", "optional_parameter_declaration"):
            declarator = parent.child_by_field_name("declarator")
            if declarator is None or declarator.id != inner.id:
                return None
            return (WriteKind.PARAMETER, parent, -1, parent.child_by_field_name("type"))
        elif kind in ("declaration", "field_declaration"):
            return _in_condition(inner, parent) or _plain(unit, name, inner, parent)
        elif not kind.endswith("_declarator") and kind != "qualified_identifier":
            return None
        inner = parent
    return None


def _in_condition(inner: Node, parent: Node) -> _Found | None:
    """Return the value of `if (Type name = value)`, which has no declarator of its own."""
    value, outer = parent.child_by_field_name("value"), parent.parent
    declarator = parent.child_by_field_name("declarator")
    if value is None or outer is None or outer.type != "condition_clause":
        return None
    same = declarator is not None and declarator.id == inner.id
    return (WriteKind.VALUE, value, -1, parent.child_by_field_name("type")) if same else None


def _initialised(inner: Node, parent: Node) -> _Found | None:
    declarator, value = parent.child_by_field_name("declarator"), parent.child_by_field_name("value")
    declaration = parent.parent
    if declarator is None or value is None or declarator.id != inner.id or declaration is None:
        return None
    kind = declaration.child_by_field_name("type")
    if value.type == "argument_list" or (value.type == "initializer_list" and not _is_array(inner)):
        return (WriteKind.CONSTRUCT, value, -1, kind)
    return (WriteKind.VALUE, value, -1, kind)


def _is_array(declarator: Node) -> bool:
    inner: Node | None = declarator
    while inner is not None and inner.type.endswith("_declarator"):
        if inner.type == "array_declarator":
            return True
        inner = inner.child_by_field_name("declarator")
    return False


def _plain(unit: Unit, name: Node, inner: Node, parent: Node) -> _Found | None:
    kind = parent.child_by_field_name("type")
    declarators = parent.children_by_field_name("declarator")
    if all(declarator.id != inner.id for declarator in declarators):
        return None
    if inner.type == "function_declarator":
        parameters = inner.child_by_field_name("parameters")
        if parent.type == "declaration" and parameters is not None and unit.function_at(name.start_byte) is not None:
            return (WriteKind.CONSTRUCT, parameters, -1, kind)
        return None
    following = False
    for index, child in enumerate(parent.children):
        role = parent.field_name_for_child(index)
        if following and role == "default_value":
            construct = child.type == "initializer_list" and not _is_array(inner)
            return (WriteKind.CONSTRUCT if construct else WriteKind.VALUE, child, -1, kind)
        if role == "declarator":
            following = child.id == inner.id
    return (WriteKind.DECLARE, parent, -1, kind)


def _extent(node: Node) -> tuple[int, int]:
    """Return the range of the branch that a node stands in; a condition belongs to what is around it."""
    inner = node
    for parent in syntax.outward(node):
        if parent.type in _BRANCHES:
            condition = parent.child_by_field_name("condition") or parent.child_by_field_name("right")
            if condition is None or condition.id != inner.id:
                return (parent.start_byte, parent.end_byte)
        inner = parent
    return (0, 1 << 62)
