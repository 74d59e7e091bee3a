"""One Python file, parsed once, whose statements and functions are lowered at their first use."""

from __future__ import annotations

from functools import cached_property
from typing import TYPE_CHECKING

from kg.extract.python.expressions import Expressions
from kg.extract.python.statements import Statements
from kg.extract.python.syntax import first_error, parse
from kg.symbolic.form import Block, Unit

if TYPE_CHECKING:
    from tree_sitter import Node

    from kg.corpus.files import FilePath
    from kg.symbolic.form import Function

__all__ = ["PythonUnit"]


class PythonUnit(Unit):
    """A lowered file. `error` is the line of the first part that does not parse, `sources` as of `Expressions`."""

    def __init__(self, key: FilePath, source: bytes, sources: dict[object, Node] | None = None) -> None:
        self.key = key
        self.source = source
        self.sources = sources
        self.root: Node = parse(source).root_node
        self._statements = Statements(self, Expressions(self, sources))
        self.error = first_error(self.root)

    @property
    def is_package(self) -> bool:
        """Whether the file is that of a package, which contains other modules."""
        return self.path.endswith("/__init__.py")

    @property
    def name(self) -> str:
        """The last part of the name of the module."""
        return self.path.removesuffix("/__init__.py").removesuffix(".py").rpartition("/")[2]

    @cached_property
    def body(self) -> Block:
        """The statements of the module."""
        return self._statements.module(self.root)

    @property
    def too_deep(self) -> int | None:
        """The line of the first statement, of those lowered so far, that is nested too deep to be read."""
        return self._statements.too_deep

    def lower_body(self, function: Function) -> Block:
        """Return the statements of a function of this file."""
        return self._statements.body(function, function.source)  # type: ignore[arg-type]  # a node of this file
