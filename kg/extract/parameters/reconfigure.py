"""Configurations of dynamic_reconfigure: `.cfg` files, which are Python programs that add parameters to a generator.

They are read, not run: every `generator.add(name, type, level, description, default, ...)` (of a group, too) is a
parameter, and `generator.generate(package, node, name)` names the configuration. A function that is called with a
generator is read wherever it is defined. Source: wiki.ros.org/dynamic_reconfigure and its `parameter_generator_catkin`.
"""

from __future__ import annotations

import json
import re
from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

from kg.extract.python.syntax import argument_nodes, captures, code, first_error, parse
from kg.facts import Access, Location, Parameter, Resolution
from kg.holes import ANONYMOUS, hole_of, is_known, is_partial

if TYPE_CHECKING:
    from collections.abc import Iterator

    from tree_sitter import Node

    from kg.corpus.files import FilePath
    from kg.corpus.reading import Reader

__all__ = ["Configuration", "read_configuration"]

_TYPES: Final = {"int_t": "int", "double_t": "double", "bool_t": "bool", "str_t": "string"}
_ADD_ARGUMENTS: Final = ("name", "paramtype", "level", "description", "default")
_GENERATE_ARGUMENTS: Final = ("pkgname", "nodename", "name")
_CONVERSION: Final = re.compile(r"%[-#0 +]*\d*(?:\.\d+)?[a-zA-Z]|\{[^{}]*\}")
_MOST_NESTED_CALLS: Final = 3
_MOST_DEPTH: Final = 40


@dataclass(frozen=True, slots=True)
class Configuration:
    """The parameters of one `.cfg` file; `name` is `package/Name` as the generated C++ and Python call it."""

    name: str | None
    parameters: tuple[Parameter, ...]


def read_configuration(reader: Reader, file: FilePath) -> Configuration:
    """Return what the `.cfg` file says; parts that do not parse are a problem KG115 of the `reader`."""
    module = _Module.read(reader, file)
    if module is None:
        return Configuration(None, ())
    names = [name for call in module.calls if (name := _generated(module, call)) is not None]
    parameters = {found.name: found for found in _parameters(module, module.calls, 0)}
    return Configuration(names[0] if names else None, tuple(parameters.values()))


@dataclass(frozen=True, slots=True)
class _Module:
    """A Python file with its calls, functions, imports and constants."""

    reader: Reader
    file: FilePath
    calls: list[Node]
    functions: dict[str, Node]
    imports: dict[str, str]
    constants: dict[str, Node]

    @classmethod
    def read(cls, reader: Reader, file: FilePath) -> _Module | None:
        content = reader.read(file)
        if content is None:
            return None
        root = parse(content).root_node
        error = first_error(root)
        if error is not None:
            reader.problem("KG115", "part of the configuration does not parse", file.path, error)
        found = captures(root)
        functions = {code(node.child_by_field_name("name")): node for node in found.get("function", ())}
        constants = {
            code(node.child_by_field_name("left")): right
            for node in found.get("assign", ())
            if (right := node.child_by_field_name("right")) is not None
        }
        calls = sorted(found.get("call", ()), key=lambda node: node.start_byte)
        return cls(reader, file, calls, functions, dict(_imports(found.get("import", []))), constants)

    def location(self, node: Node) -> Location:
        """Return where a node stands; the name of its source only where it is another one."""
        here = self.reader.repository
        other = self.file.repository if self.file.repository != here else None
        return Location(self.file.path, node.start_point.row + 1, other)


def _imports(nodes: list[Node]) -> Iterator[tuple[str, str]]:
    """Yield the names that `from module import name` brings in, each with its module."""
    for node in nodes:
        module = node.child_by_field_name("module_name")
        for name in node.children_by_field_name("name") if module is not None else ():
            yield code(name), code(module)


def _parameters(module: _Module, calls: list[Node], depth: int) -> Iterator[Parameter]:
    for call in calls:
        function = call.child_by_field_name("function")
        if function is None:
            continue
        if function.type == "attribute":
            if code(function.child_by_field_name("attribute")) == "add":
                yield from _added(module, call)
        elif function.type == "identifier" and depth < _MOST_NESTED_CALLS:
            yield from _elsewhere(module, code(function), depth)


def _elsewhere(module: _Module, name: str, depth: int) -> Iterator[Parameter]:
    """Yield what a function adds that another module of the build defines; those of this one are read with it."""
    dotted = module.imports.get(name)
    file = module.reader.workspace.module(dotted, near=module.file) if dotted else None
    other = _Module.read(module.reader, file) if file else None
    function = other.functions.get(name) if other else None
    if other and function:
        yield from _parameters(other, [call for call in other.calls if _within(call, function)], depth + 1)


def _within(inner: Node, outer: Node) -> bool:
    return outer.start_byte <= inner.start_byte and inner.end_byte <= outer.end_byte


def _added(module: _Module, call: Node) -> Iterator[Parameter]:
    given = _arguments(call, _ADD_ARGUMENTS)
    kind = _TYPES.get(code(given.get("paramtype")).rpartition(".")[2])
    name = _text(module, given.get("name"))
    if kind is None or not name:
        return
    description = _text(module, given.get("description"))
    yield Parameter(
        name=name,
        type=kind,
        default=_default(given.get("default")),
        access=Access.READ,
        location=module.location(call),
        resolution=Resolution.PARTIAL if is_partial(name) else Resolution.LITERAL,
        description=description if is_known(description) else None,
    )


def _generated(module: _Module, call: Node) -> str | None:
    """Return the name of the configuration if the call is `generator.generate(package, node, name)`."""
    function = call.child_by_field_name("function")
    if function is None or code(function.child_by_field_name("attribute")) != "generate":
        return None
    given = _arguments(call, _GENERATE_ARGUMENTS)
    package, name = _text(module, given.get("pkgname")), _text(module, given.get("name"))
    return f"{package}/{name}" if package and name else None


def _arguments(call: Node, names: tuple[str, ...]) -> dict[str, Node]:
    """Return the arguments of a call by the names of the parameters they go to."""
    given: dict[str, Node] = {}
    positional = iter(names)
    for argument in argument_nodes(call):
        if argument.type == "keyword_argument":
            value = argument.child_by_field_name("value")
            if value is not None:
                given[code(argument.child_by_field_name("name"))] = value
        elif (name := next(positional, None)) is not None:
            given[name] = argument
    return given


def _text(module: _Module, node: Node | None, depth: int = 0) -> str | None:
    """Return the string that an expression makes, with holes for what is not known; None where it makes none."""
    if node is None or depth > _MOST_DEPTH:
        return None
    if node.type == "string":
        return "".join(code(child) for child in node.children if child.type == "string_content")
    if node.type == "concatenated_string":
        return "".join(_text(module, child, depth + 1) or "" for child in node.named_children)
    if node.type == "parenthesized_expression" and node.named_child_count:
        return _text(module, node.named_children[0], depth + 1)
    if node.type == "identifier":
        return _text(module, module.constants.get(code(node)), depth + 1)
    if node.type == "binary_operator":
        return _combined(module, node, depth)
    return None


def _combined(module: _Module, node: Node, depth: int) -> str | None:
    left = _text(module, node.child_by_field_name("left"), depth + 1)
    right = _text(module, node.child_by_field_name("right"), depth + 1)
    operator = code(node.child_by_field_name("operator"))
    if operator == "+" and (left or right):
        return f"{left or _hole(node, 'left')}{right or _hole(node, 'right')}"
    return _CONVERSION.sub(ANONYMOUS, left) if operator == "%" and left else None


def _hole(node: Node, side: str) -> str:
    """Return the hole of an operand that is not known, with the label of its variable."""
    operand = node.child_by_field_name(side)
    return hole_of(code(operand)) if operand is not None and operand.type == "identifier" else ANONYMOUS


def _default(node: Node | None) -> str | None:
    """Return a default as YAML; None for one that had to be computed."""
    if node is None:
        return None
    text = code(node)
    if node.type in {"true", "false"}:
        return text.lower()
    if node.type == "string":
        return json.dumps("".join(code(child) for child in node.children if child.type == "string_content"))
    number = node.child_by_field_name("argument") if node.type == "unary_operator" else node
    return text.replace(" ", "") if number is not None and number.type in {"integer", "float"} else None
