"""Macros of xacro: their parameters, and the scope that a call makes of them.

Source: wiki.ros.org/xacro, "Macros", "Default parameter values".
"""

from __future__ import annotations

import re
from typing import TYPE_CHECKING, Final

from kg.extract.launch.expressions import NotKnownError
from kg.extract.launch.ros1.texts import HOLE
from kg.extract.launch.xacro.table import Block, Macro, Table

if TYPE_CHECKING:
    from collections.abc import Sequence

    from kg.corpus.files import FilePath
    from kg.extract.launch.xacro.document import Element
    from kg.extract.launch.xacro.texts import Texts

__all__ = ["called", "grab_macro"]

_PARAMETER: Final = re.compile(
    r"""\s*(?P<name>[^\s:=]+)"""
    r"""(?P<given>\s*:?=\s*(?P<forward>\^\|?)?"""
    r"""(?P<default>\$\{[^}]*\}|\$\([^)]*\)|(?:'[^']*'|"[^"]*"|[^\s'"])*))?(?=\s|$)"""
)
_MOST_PARAMETERS: Final = 1000


def grab_macro(element: Element, file: FilePath) -> Macro:
    """Return the macro that an element defines."""
    parameters: dict[str, tuple[bool, str | None] | None] = {}
    for found in _PARAMETER.finditer(element.attributes.get("params", "")):
        if len(parameters) >= _MOST_PARAMETERS:
            break
        default = (found["forward"] is not None, found["default"] or None) if found["given"] else None
        parameters[found["name"]] = default
    return Macro(element.attributes.get("name", "").removeprefix("xacro:"), element, parameters, file)


def called(macro: Macro, around: Table, call: tuple[Element, Table], blocks: Sequence[Block], texts: Texts) -> Table:
    """Return the scope of a macro's body: what the `call` gives, an element and its scope, else the defaults."""
    element, caller = call
    scope = Table(texts.value, around)
    waiting = iter(blocks)
    for name, default in macro.parameters.items():
        if name.startswith("*"):
            block = next(waiting, None)
            if block is not None:
                scope.blocks[name.lstrip("*")] = _content(block) if name.startswith("**") else block
        elif name in element.attributes:
            scope.set(name, texts.value(element.attributes[name], caller))
        elif default is not None:
            scope.set(name, _default(name, default, around, texts))
        else:
            scope.set(name, HOLE)
    return scope


def _default(name: str, default: tuple[bool, str | None], caller: Table, texts: Texts) -> object:
    forward, written = default
    if forward and name in caller:
        try:
            return caller[name]
        except NotKnownError:
            return HOLE
    return HOLE if written is None and forward else texts.value(written or "", caller)


def _content(block: Block) -> Block:
    """Return what stands in the one element of a block."""
    inner = (child for element in block.elements if not isinstance(element, str) for child in element.children)
    return Block(tuple(inner), block.scope, block.file)
