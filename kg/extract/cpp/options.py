"""Interfaces that ROS 1 code describes by options first: `ros::SubscribeOptions` and its like.

`options.init<T>("topic", ...)` and `ros::SubscribeOptions::create<T>("topic", ...)` name the interface; the
node handle is that of the later call `handle.subscribe(options)`. Source: ros/subscribe_options.h and others.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from kg.extract.cpp import syntax
from kg.extract.cpp.unit import Expr

if TYPE_CHECKING:
    from tree_sitter import Node

    from kg.extract.cpp.unit import Unit

__all__ = ["consumer"]


def consumer(where: Expr, receiver: Node | None) -> Expr | None:
    """Return the node handle that the options made by the call `where` are handed to; None where none is in sight."""
    unit = where.unit
    outer = where.node.parent
    if receiver is None and outer is not None and outer.type == "argument_list":
        return _handle(unit, outer)
    name = syntax.text(receiver) if receiver is not None else _assigned(outer)
    function = unit.function_at(where.at)
    for node in unit.occurrences(name or ""):
        within = function is not None and function.start <= node.start_byte < function.end
        parent = node.parent
        if within and parent is not None and parent.type == "argument_list" and len(syntax.arguments(parent)) == 1:
            return _handle(unit, parent)
    return None


def _assigned(outer: Node | None) -> str | None:
    if outer is None or outer.type not in ("init_declarator", "assignment_expression"):
        return None
    target = outer.child_by_field_name("declarator") or outer.child_by_field_name("left")
    return syntax.text(target) if target is not None else None


def _handle(unit: Unit, arguments: Node) -> Expr | None:
    call = arguments.parent
    function = call.child_by_field_name("function") if call is not None else None
    called = syntax.callee(function) if function is not None else None
    return Expr.of(unit, called.receiver) if called is not None and called.receiver is not None else None
