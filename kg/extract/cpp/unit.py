"""One file of C++: its tree and what it defines.

Definitions are indexed by one query at C speed. Everything else is found on demand: `Unit.occurrences`
searches the bytes for a word and asks the tree what stands there, which is far cheaper than an index of
all words when only a few are ever asked for.
"""

from __future__ import annotations

from bisect import bisect_right
from dataclasses import dataclass, field
from functools import cache, cached_property, lru_cache
from typing import TYPE_CHECKING, Any, Final

from tree_sitter import Query, QueryCursor

from kg.extract.cpp import syntax

if TYPE_CHECKING:
    from collections.abc import Hashable, Iterable

    from tree_sitter import Node

    from kg.corpus.workspace import FilePath

__all__ = ["Class", "Expr", "Function", "Parameter", "Unit", "included"]

_STRUCTURE: Final = """
(function_definition) @function
(class_specifier body: (_)) @class
(struct_specifier body: (_)) @class
(namespace_definition) @namespace
(alias_declaration) @alias
(type_definition) @typedef
(using_declaration) @using
(namespace_alias_definition) @namespace_alias
(preproc_def) @define
(preproc_if condition: (number_literal) @never)
(translation_unit (declaration) @global)
(namespace_definition body: (declaration_list (declaration) @global))
[(comment) (string_literal) (raw_string_literal) (char_literal) (system_lib_string)] @silent
[(preproc_arg) (namespace_identifier) (statement_identifier)] @silent
"""
_NAMES: Final = frozenset({"identifier", "field_identifier", "type_identifier", "namespace_identifier"})
_ROW: Final = "comma_expression"
_SHELLS: Final = frozenset({"translation_unit", "expression_statement", "parenthesized_expression"})
_CLASS_HEAD: Final = 200
"""Bytes that `class MACRO Name` fits in."""
_WORD: Final = frozenset(b"abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_")
_WORDS_ONLY: Final = bytes(byte if byte in _WORD or byte > 0x7F else 0x20 for byte in range(256))  # noqa: PLR2004 - ASCII
"""Translates bytes so that words stand alone between spaces."""


@cache
def _shells() -> Query:
    """Return the query for what stands where a function has its type and is a class without a body."""
    kinds = "[(class_specifier name: (type_identifier) @macro) (struct_specifier name: (type_identifier) @macro)]"
    return Query(syntax.LANGUAGE, f"(function_definition type: {kinds})")


@cache
def _structure() -> Query:
    return Query(syntax.LANGUAGE, _STRUCTURE)


@cache
def _members() -> Query:
    return Query(syntax.LANGUAGE, "[(field_identifier) (friend_declaration)] @member")


@lru_cache(maxsize=64)
def _spelled(words: tuple[str, ...]) -> tuple[tuple[str, bytes], ...]:
    """Return each word with its bytes."""
    return tuple((word, word.encode()) for word in words)


def included(source: bytes) -> list[str]:
    """Return the paths of the `#include` lines of a file, in order."""
    found = []
    position = source.find(b"#")
    while position >= 0:
        end = source.find(b"\n", position)
        line = source[position + 1 : end if end >= 0 else len(source)].strip()
        if line.startswith(b"include"):
            path = line.removeprefix(b"include").strip()
            closing = path.find(b">" if path.startswith(b"<") else b'"', 1)
            if path[:1] in (b"<", b'"') and closing > 0:
                found.append(path[1:closing].decode("utf-8", "replace"))
        position = source.find(b"#", max(end, position + 1)) if end >= 0 else -1
    return found


@dataclass(slots=True, eq=False)
class Expr:
    """An expression where it stands: `at` is the byte from which its names are looked up. Nothing changes it.

    It is not frozen because one is made for every argument of every call, and frozen ones take three times as long.
    """

    unit: Unit
    node: Node
    at: int

    @classmethod
    def of(cls, unit: Unit, node: Node) -> Expr:
        """Return the expression `node` of `unit`."""
        return cls(unit, node, node.start_byte)

    def child(self, node: Node) -> Expr:
        """Return an expression beside or below this one, seen from the same place."""
        return Expr(self.unit, node, node.start_byte if self.at == self.node.start_byte else self.at)

    @property
    def line(self) -> int:
        """The line of the expression, from one."""
        return self.unit.line(self.at)


@dataclass(frozen=True, slots=True)
class Parameter:
    """A parameter of a function: its type as a node, its default."""

    name: str
    type: Node | None
    default: Node | None


@dataclass(slots=True, eq=False)
class Function:
    """A function with a body. `scope` holds the namespaces and classes around it, from the outside in."""

    unit: Unit
    node: Node
    name: str
    scope: tuple[str, ...]
    inside: Class | None
    start: int
    end: int
    _parameters: tuple[Parameter, ...] | None = field(default=None, repr=False)
    _words: frozenset[str] | None = field(default=None, repr=False)

    @property
    def owner(self) -> str | None:
        """The name of the class it may be a method of."""
        return self.scope[-1] if self.scope else None

    @property
    def declarator(self) -> Node | None:
        """The node with the name and the parameters."""
        return _function_declarator(self.node)

    @property
    def parameters(self) -> tuple[Parameter, ...]:
        """Its parameters in order."""
        if self._parameters is None:
            declarator = self.declarator
            self._parameters = () if declarator is None else read_parameters(declarator)
        return self._parameters

    @property
    def initialisers(self) -> list[Node]:
        """The entries of a constructor's initialiser list."""
        for child in self.node.named_children:
            if child.type == "field_initializer_list":
                return [entry for entry in child.named_children if entry.type == "field_initializer"]
        return []

    @property
    def words(self) -> frozenset[str]:
        """Every word of code in it."""
        if self._words is None:
            self._words = self.unit.words(self.start, self.end)
        return self._words


@dataclass(slots=True, eq=False)
class Class:
    """A class or struct with a body; `scope` as in `Function`."""

    unit: Unit
    node: Node
    name: str
    scope: tuple[str, ...]
    start: int
    end: int
    _fields: dict[str, tuple[Node, Node | None, Node]] | None = field(default=None, repr=False)
    _words: frozenset[str] | None = field(default=None, repr=False)

    @property
    def qualified(self) -> str:
        """The name with its namespaces."""
        return "::".join((*self.scope, self.name))

    @property
    def bases(self) -> list[Node]:
        """The type nodes of its base classes."""
        for child in self.node.named_children:
            if child.type == "base_class_clause":
                return [c for c in child.named_children if c.type not in ("access_specifier", "virtual", "comment")]
        return []

    @property
    def fields(self) -> dict[str, tuple[Node, Node | None, Node]]:
        """Declared members by name: type, default value, and the declarator."""
        if self._fields is None:
            self._fields = dict(_read_fields(self.node.child_by_field_name("body")))
        return self._fields

    @property
    def words(self) -> frozenset[str]:
        """Every word of its declarations, without the names of members, friends and the bodies of methods."""
        if self._words is None:
            inner = [(f.start, f.end) for f in self.unit.functions if f.inside is self]
            members = QueryCursor(_members()).captures(self.node).get("member", [])
            left_out = [*inner, *((n.start_byte, n.end_byte) for n in members)]
            self._words = self.unit.words(self.start, self.end, left_out)
        return self._words


def _function_declarator(node: Node) -> Node | None:
    declarator = node.child_by_field_name("declarator")
    for _ in range(8):
        if declarator is None or declarator.type == "function_declarator":
            return declarator
        inner = declarator.child_by_field_name("declarator")
        if inner is None:
            inner = next((c for c in declarator.named_children if c.type == "function_declarator"), None)
        declarator = inner
    return None


def read_parameters(declarator: Node) -> tuple[Parameter, ...]:
    """Return the parameters of a function or lambda declarator."""
    found = []
    for child in syntax.arguments(declarator.child_by_field_name("parameters")):
        if child.type in ("parameter_declaration", "optional_parameter_declaration", "variadic_parameter_declaration"):
            name = syntax.declared_name(child.child_by_field_name("declarator"))
            default = child.child_by_field_name("default_value")
            found.append(Parameter(syntax.text(name) if name else "", child.child_by_field_name("type"), default))
    return tuple(found)


def _read_fields(body: Node | None) -> list[tuple[str, tuple[Node, Node | None, Node]]]:
    found: list[tuple[str, tuple[Node, Node | None, Node]]] = []
    pending = list(body.named_children) if body is not None else []
    while pending:
        member = pending.pop(0)
        if member.type.startswith("preproc_"):
            pending = [c for c in member.named_children if c.type.endswith("declaration")] + pending
        kind = member.child_by_field_name("type") if member.type == "field_declaration" else None
        if kind is None:
            continue
        latest = None
        for index, child in enumerate(member.children):
            role = member.field_name_for_child(index)
            if role == "declarator":
                name = syntax.declared_name(child)
                latest = syntax.text(name) if name is not None else None
                if latest is not None:
                    found.append((latest, (kind, None, child)))
            elif role == "default_value" and latest is not None:
                found[-1] = (latest, (kind, child, found[-1][1][2]))
    return found


@dataclass(slots=True, eq=False)
class _Structure:
    functions: list[Function]
    classes: list[Class]
    namespaces: list[tuple[int, int, tuple[str, ...]]]
    captures: dict[str, list[Node]]
    code: bytes
    """The source without comments, texts and the names of namespaces."""


class Unit:
    """A parsed file; `file` says which, `source` holds its bytes."""

    def __init__(self, file: FilePath, source: bytes) -> None:
        self.file = file
        self.source = source
        self.tree = syntax.parse(source)
        hidden = _visibility_macros(self.tree.root_node) if _may_hide_classes(source) else []
        if hidden:
            self.tree = syntax.parse(_blanked(source, [(n.start_byte, n.end_byte) for n in hidden]))
        self.root = self.tree.root_node
        self._occurrences: dict[str, list[Node]] = {}
        self.memory: dict[Hashable, Any] = {}
        """What readers of the unit found out once and need again; it depends on nothing but the unit."""

    def reparse(self, node: Node) -> list[Node]:
        """Return the arguments in what was taken for a parameter list: `Foo foo(bar);` is ambiguous C++.

        The same bytes are parsed as an expression, so that places stay true.
        """
        tree = syntax.parse_range(self.source, node)
        found = [tree.root_node.descendant_for_byte_range(node.start_byte, node.end_byte)]
        given: list[Node] = []
        while found:
            inner = found.pop(0)
            if inner is not None and (inner.type == _ROW or (not given and inner.type in _SHELLS)):
                found[:0] = inner.named_children
            elif inner is not None and inner.type != "comment":
                given.append(inner)
        return given

    def line(self, at: int) -> int:
        """Return the line of a byte, from one."""
        return bisect_right(self._lines, at)

    @cached_property
    def _lines(self) -> list[int]:
        starts, position = [0], self.source.find(b"\n")
        while position >= 0:
            starts.append(position + 1)
            position = self.source.find(b"\n", position + 1)
        return starts

    @cached_property
    def includes(self) -> list[str]:
        """The paths it includes, as written."""
        return included(self.source)

    @cached_property
    def _structure(self) -> _Structure:
        return _arrange(self, QueryCursor(_structure()).captures(self.root))

    @property
    def functions(self) -> list[Function]:
        """Functions with bodies, in order."""
        return self._structure.functions

    @property
    def classes(self) -> list[Class]:
        """Classes with bodies, in order."""
        return self._structure.classes

    def captured(self, name: str) -> list[Node]:
        """Return the nodes of one capture of the structure query."""
        return self._structure.captures.get(name, [])

    @cached_property
    def _starts(self) -> list[int]:
        return [function.start for function in self.functions]

    def function_at(self, at: int) -> Function | None:
        """Return the innermost function around a byte."""
        index = bisect_right(self._starts, at) - 1
        while index >= 0:
            function = self.functions[index]
            if at < function.end:
                return function
            index -= 1
            if function.inside is None:
                break
        return None

    def class_at(self, at: int) -> Class | None:
        """Return the innermost class whose body is around a byte."""
        return max(
            (c for c in self.classes if c.start <= at < c.end),
            key=lambda c: c.start,
            default=None,
        )

    def scope_at(self, at: int) -> tuple[str, ...]:
        """Return the namespaces around a byte."""
        around = [names for start, end, names in self._structure.namespaces if start <= at < end]
        return tuple(name for names in around for name in names)

    def having(self, words: tuple[str, ...]) -> tuple[str, ...]:
        """Return those of some words, in their order, that stand anywhere in the file: a first and cheap look."""
        vocabulary = self._vocabulary
        return tuple(word for word, spelled in _spelled(words) if spelled in vocabulary)

    @cached_property
    def _vocabulary(self) -> frozenset[bytes]:
        return frozenset(self.source.translate(_WORDS_ONLY).split())

    def occurrences(self, word: str) -> list[Node]:
        """Return the names in the code that are exactly `word`."""
        found = self._occurrences.get(word)
        if found is None:
            found = self._occurrences[word] = self._search(word.encode()) if word else []
        return found

    def _search(self, word: bytes) -> list[Node]:
        found: list[Node] = []
        source, position = self.source, self.source.find(word)
        while position >= 0:
            end = position + len(word)
            before = source[position - 1] if position else 0
            if before not in _WORD and (end >= len(source) or source[end] not in _WORD):
                node = self.root.descendant_for_byte_range(position, end)
                off = any(start <= position < stop for start, stop in self._switched_off)
                whole = node is not None and node.end_byte - node.start_byte == len(word)
                if node is not None and whole and node.type in _NAMES and not off:
                    found.append(node)
            position = source.find(word, end)
        return found

    @cached_property
    def _switched_off(self) -> list[tuple[int, int]]:
        """The ranges of bytes that `#if 0` takes out."""
        ranges = []
        for number in self.captured("never"):
            block = number.parent
            if block is not None and number.text == b"0":
                other = block.child_by_field_name("alternative")
                ranges.append((number.end_byte, other.start_byte if other is not None else block.end_byte))
        return ranges

    def words(self, start: int, end: int, without: Iterable[tuple[int, int]] = ()) -> frozenset[str]:
        """Return the words of code, but names of namespaces, between two bytes, and not in the ranges `without`."""
        code = self._structure.code[start:end]
        if without:
            code = _blanked(code, [(first - start, last - start) for first, last in without])
        return frozenset(code.translate(_WORDS_ONLY).decode("utf-8", "replace").split())

    @cached_property
    def aliases(self) -> dict[str, list[Node]]:
        """Types behind the names that `using` and `typedef` give, by name."""
        found: dict[str, list[Node]] = {}
        for node in self.captured("alias"):
            name, kind = node.child_by_field_name("name"), node.child_by_field_name("type")
            if name is not None and kind is not None:
                found.setdefault(syntax.text(name), []).append(kind)
        for node in self.captured("typedef"):
            name = syntax.declared_name(node.child_by_field_name("declarator"))
            kind = node.child_by_field_name("type")
            if name is not None and kind is not None:
                found.setdefault(syntax.text(name), []).append(kind)
        for node in self.captured("using"):
            target = node.named_children[0] if node.named_children else None
            if target is not None and target.type == "qualified_identifier" and b"namespace" not in (node.text or b""):
                found.setdefault(syntax.simple_name(target), []).append(target)
        return found

    @cached_property
    def used_namespaces(self) -> list[str]:
        """The namespaces of its `using namespace` directives, as written."""
        return [
            syntax.text(node.named_children[0])
            for node in self.captured("using")
            if node.named_children and (node.text or b"").startswith(b"using namespace")
        ]

    @cached_property
    def namespace_aliases(self) -> dict[str, str]:
        """Other names of namespaces."""
        found = {}
        for node in self.captured("namespace_alias"):
            children = node.named_children
            if len(children) > 1:
                found[syntax.text(children[0])] = syntax.text(children[1])
        return found

    @cached_property
    def macros(self) -> dict[str, str]:
        """The text of macros without parameters."""
        found = {}
        for node in self.captured("define"):
            name, value = node.child_by_field_name("name"), node.child_by_field_name("value")
            if name is not None and value is not None:
                found[syntax.text(name)] = syntax.text(value).strip()
        return found


def _may_hide_classes(source: bytes) -> bool:
    """Tell, without the tree, whether two words stand between `class` or `struct` and what follows a class name."""
    for keyword in (b"class ", b"struct "):
        position = source.find(keyword)
        while position >= 0:
            head = source[position : position + _CLASS_HEAD].partition(b"{")[0].partition(b":")[0].partition(b";")[0]
            words = head.split()
            if len(words) > 2 and words[2] not in (b"final", b"="):  # noqa: PLR2004 - keyword, macro, name
                return True
            position = source.find(keyword, position + len(keyword))
    return False


def _visibility_macros(root: Node) -> list[Node]:
    """Return the macros in `class MACRO Name : Base {...};`, which the grammar takes for the name of the class."""
    found = syntax.captures(_shells(), root).get("macro", [])
    return [node for node in found if node.parent is not None and node.parent.child_by_field_name("body") is None]


def _blanked(source: bytes, ranges: Iterable[tuple[int, int]]) -> bytes:
    """Return a source with ranges of bytes as spaces, so that all places stay true."""
    changed = bytearray(source)
    for start, end in ranges:
        changed[start:end] = b" " * (end - start)
    return bytes(changed)


def _arrange(unit: Unit, captures: dict[str, list[Node]]) -> _Structure:
    """Nest namespaces, classes and functions by their places."""
    entries = [
        (n.start_byte, -n.end_byte, kind, n)
        for kind in ("namespace", "class", "function")
        for n in captures.get(kind, [])
    ]
    entries.sort(key=lambda entry: entry[:2])
    silent = ((n.start_byte, n.end_byte) for n in captures.pop("silent", ()))
    for nodes in captures.values():  # sorted here and not by `syntax.captures`, which need not sort the many above
        nodes.sort(key=lambda node: (node.start_byte, -node.end_byte))
    result = _Structure([], [], [], captures, _blanked(unit.source, silent))
    around: list[tuple[int, tuple[str, ...], Class | None]] = []
    for start, minus_end, kind, node in entries:
        end = -minus_end
        while around and around[-1][0] <= start:
            around.pop()
        scope = tuple(name for _, names, _ in around for name in names)
        inside = around[-1][2] if around else None
        if kind == "namespace":
            name = node.child_by_field_name("name")
            names = tuple(syntax.text(name).replace(" ", "").split("::")) if name is not None else ()
            result.namespaces.append((start, end, names))
            around.append((end, names, None))
        elif kind == "class":
            made = Class(unit, node, _class_name(node), scope, start, end)
            result.classes.append(made)
            around.append((end, (made.name,), made))
        else:
            _add_function(unit, node, scope, inside, result)
    return result


def _class_name(node: Node) -> str:
    name = node.child_by_field_name("name")
    return syntax.simple_name(name) if name is not None else ""


def _add_function(unit: Unit, node: Node, scope: tuple[str, ...], inside: Class | None, result: _Structure) -> None:
    declarator = _function_declarator(node)
    name = declarator.child_by_field_name("declarator") if declarator is not None else None
    if name is None:
        return
    outer, inner = syntax.split_scope(name)
    result.functions.append(
        Function(unit, node, syntax.simple_name(inner), (*scope, *outer), inside, node.start_byte, node.end_byte)
    )
