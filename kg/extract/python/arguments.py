"""Arguments of calls: finding one by position or name, and binding all to the parameters of a function."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING

from kg.extract.python.entities import Thunk
from kg.extract.python.syntax import argument_nodes, code

if TYPE_CHECKING:
    from tree_sitter import Node

    from kg.extract.python.entities import Frame
    from kg.extract.python.unit import Parameters, Scope

__all__ = ["Arguments", "bind", "read_arguments"]


@dataclass(slots=True)
class Arguments:
    """The arguments of one call, not yet evaluated; `starred` when some are spread from a value not known here."""

    positional: list[Thunk] = field(default_factory=list)
    named: dict[str, Thunk] = field(default_factory=dict)
    starred: bool = False

    def get(self, index: int | None, *names: str) -> Thunk | None:
        """Return the argument at a position or under one of the names."""
        for name in names:
            if name in self.named:
                return self.named[name]
        if index is not None and index < len(self.positional):
            return self.positional[index]
        return None


def read_arguments(call: Node, frame: Frame) -> Arguments:
    """Return the arguments of a call made in `frame`; `*args` and `**kwargs` of the caller are passed on."""
    found = Arguments()
    for node in argument_nodes(call):
        if node.type == "keyword_argument":
            value = node.child_by_field_name("value")
            found.named[code(node.child_by_field_name("name"))] = Thunk(value, frame)
        elif node.type == "list_splat":
            _spread(node, frame, found)
        elif node.type == "dictionary_splat":
            _spread_named(node, frame, found)
        else:
            found.positional.append(Thunk(node, frame))
    return found


def _spread(node: Node, frame: Frame, found: Arguments) -> None:
    inner = node.named_children[0]
    if code(inner) == frame.scope.parameters.rest:
        found.positional.extend(frame.rest)
    elif inner.type in ("list", "tuple"):
        found.positional.extend(Thunk(item, frame) for item in inner.named_children)
    else:
        found.starred = True


def _spread_named(node: Node, frame: Frame, found: Arguments) -> None:
    inner = node.named_children[0]
    if code(inner) == frame.scope.parameters.keywords:
        for name, thunk in frame.keywords.items():
            found.named.setdefault(name, thunk)
    else:
        found.starred = True


def bind(arguments: Arguments, scope: Scope, frame: Frame, *, skip: int) -> None:
    """Bind arguments to the parameters of `scope` in its new `frame`; the first `skip` parameters are given already."""
    parameters: Parameters = scope.parameters
    names = parameters.positional[skip:]
    for name, thunk in zip(names, arguments.positional, strict=False):
        frame.arguments[name] = thunk
    frame.rest = tuple(arguments.positional[len(names) :])
    for name, thunk in arguments.named.items():
        if name in parameters.positional:
            frame.arguments[name] = thunk
        else:
            frame.keywords[name] = thunk
