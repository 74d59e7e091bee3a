"""One file of C++: its declarations, with the bodies of functions lowered at their first use."""

from __future__ import annotations

import re
from collections import defaultdict
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Final, cast

from kg.extract.cpp import syntax
from kg.extract.cpp.expressions import PREPROCESSED, Expressions, line_of
from kg.extract.cpp.includes import included
from kg.extract.cpp.statements import Statements
from kg.symbolic.form import Block, Class, Field, Function, Initialiser, Parameter, Type, Unit

if TYPE_CHECKING:
    from tree_sitter import Node

    from kg.corpus.files import FilePath
    from kg.symbolic.form import Declare

__all__ = ["CppUnit", "Macro"]

_CONTAINERS: Final = PREPROCESSED | {"translation_unit", "linkage_specification", "declaration_list"}
_CLASSES: Final = frozenset({"class_specifier", "struct_specifier", "union_specifier", "enum_specifier"})
_ADAPTER: Final = "RCLCPP_USING_CUSTOM_TYPE_AS_ROS_MESSAGE_TYPE"
_CLASS_HEAD: Final = re.compile(rb"\b(class|struct)(\s+)([A-Z][A-Z0-9_]{3,})(\s+)(?=[A-Za-z_]\w*\s*(?:final\s*)?[:{])")


_ASCII: Final = 128
_WORDS: Final = bytes(code if code >= _ASCII or chr(code).isalnum() or code == ord("_") else 32 for code in range(256))
"""A table that replaces all bytes that are not part of a word by spaces."""


@dataclass(slots=True, eq=False)
class Macro:
    """A macro; `parameters` is None for one without a parameter list."""

    unit: CppUnit
    name: str
    parameters: tuple[str, ...] | None
    text: str
    line: int
    function: Function | None = None
    """The macro as a function, once it was expanded."""


class CppUnit(Unit):
    """The declarations of one file, by name."""

    def __init__(self, key: FilePath, source: bytes) -> None:
        self.key = key
        # An export macro between `class` and the name hides the class from the grammar.
        self.source = (
            _CLASS_HEAD.sub(lambda m: m[1] + m[2] + b" " * len(m[3]) + m[4], source)
            if b"class" in source or b"struct" in source
            else source
        )
        self.classes: dict[str, list[Class]] = defaultdict(list)
        self.functions: dict[str, list[Function]] = defaultdict(list)
        """Functions with bodies at namespace scope, also methods, by their last name."""
        self.prototypes: dict[str, list[Function]] = defaultdict(list)
        self.aliases: dict[str, list[tuple[tuple[str, ...], Type, tuple[str, ...]]]] = defaultdict(list)
        """Names of types: scope, type, template parameters."""
        self.variables: dict[str, list[tuple[tuple[str, ...], Declare]]] = defaultdict(list)
        self.macros: dict[str, Macro] = {}
        self.namespaces: dict[str, tuple[str, ...]] = {}
        """Other names for namespaces."""
        self.uses: list[tuple[str, ...]] = []
        """Namespaces of `using namespace`."""
        self.enumerators: set[str] = set()
        self.registrations: list[Node] = []
        self.adapted: dict[str, list[tuple[tuple[str, ...], Type]]] = defaultdict(list)
        """Types that stand for a message, by their last name: their scope as written, and the message."""
        self.tree = syntax.parse(self.source)
        self._expressions = Expressions(self)
        self._statements = Statements(self._expressions, self.source)
        self._read(self.tree.root_node, ())

    @cached_property
    def includes(self) -> list[str]:
        """The paths that it includes, as written."""
        return included(self.source)

    @cached_property
    def words(self) -> frozenset[bytes]:
        """The words of the source."""
        return frozenset(self.source.translate(_WORDS).split())

    def lower_body(self, function: Function) -> Block:
        """Return the statements of a function of this file."""
        return self._statements.block(cast("Node | None", function.source))

    # Declarations

    def _read(self, node: Node, scope: tuple[str, ...]) -> None:
        for child in node.named_children:
            self._declaration(child, scope, ())

    def _declaration(self, node: Node, scope: tuple[str, ...], template: tuple[str, ...]) -> None:
        kind = node.type
        if kind == "function_definition":
            self._function(node, scope, template)
        elif kind == "namespace_definition":
            name, body = node.child_by_field_name("name"), node.child_by_field_name("body")
            inner = tuple(syntax.text(name).split("::")) if name is not None else ()
            if body is not None:
                self._read(body, (*scope, *(part.strip() for part in inner)))
        elif kind in _CLASSES:
            self._type(node, scope, template)
        elif kind == "template_declaration":
            names = _template_names(node)
            for child in node.named_children:
                if child.type != "template_parameter_list":
                    self._declaration(child, scope, names)
        elif kind == "declaration":
            self._variables(node, scope)
        elif kind in ("alias_declaration", "type_definition"):
            self._alias(node, scope, template)
        elif kind == "using_declaration":
            self._using(node, scope)
        elif kind == "namespace_alias_definition":
            parts = [c for c in node.named_children if c.type != "comment"]
            if len(parts) > 1:
                self.namespaces[syntax.text(parts[0])] = tuple(syntax.text(parts[1]).replace(" ", "").split("::"))
        elif kind == "preproc_def":
            self._macro(node, None)
        elif kind == "preproc_function_def":
            listed = node.child_by_field_name("parameters")
            self._macro(node, tuple(syntax.text(c) for c in listed.named_children) if listed is not None else ())
        elif kind in _CONTAINERS:
            if kind != "preproc_if" or _condition(node) != "0":
                self._read(node, scope)
        elif kind == "expression_statement":
            for child in node.named_children:
                if child.type == "call_expression":
                    self.registrations.append(child)
                    self._adapter(child)

    def _adapter(self, call: Node) -> None:
        """Read the macro that states which message a type stands for."""
        given = syntax.arguments(call.child_by_field_name("arguments"))
        if len(given) == len(("type", "message")) and syntax.text(call).startswith(_ADAPTER):
            *scope, name = [part.name for part in syntax.parts(given[0]) if part.name]
            self.adapted[name].append((tuple(scope), self._expressions.type(given[1])))

    def _macro(self, node: Node, parameters: tuple[str, ...] | None) -> None:
        name, value = node.child_by_field_name("name"), node.child_by_field_name("value")
        if name is not None and value is not None:
            text = syntax.text(value).replace("\\\n", "\n").strip()
            shown = syntax.text(name)
            self.macros[shown] = Macro(self, shown, parameters, text, line_of(node))

    def _using(self, node: Node, scope: tuple[str, ...]) -> None:
        named = syntax.of_type(node, "identifier", "qualified_identifier", "namespace_identifier")
        if not named:
            return
        names = tuple(name for name in syntax.text(named[0]).replace(" ", "").split("::") if name)
        if any(c.type == "namespace" for c in node.children):
            self.uses.append(names)
        elif len(names) > 1 and names[-1] != names[-2]:
            self.aliases[names[-1]].append((scope, Type(names), ()))

    def _alias(self, node: Node, scope: tuple[str, ...], template: tuple[str, ...]) -> None:
        kind = node.child_by_field_name("type")
        if node.type == "alias_declaration":
            names = [node.child_by_field_name("name")]
        else:
            names = [syntax.declared_name(d) for d in node.children_by_field_name("declarator")]
        if kind is not None and kind.child_by_field_name("body") is not None:
            self._type(kind, scope, template)
        for name in names:
            if name is not None and kind is not None:
                self.aliases[syntax.text(name)].append((scope, self._expressions.type(kind), template))

    def _variables(self, node: Node, scope: tuple[str, ...]) -> None:
        kind = node.child_by_field_name("type")
        if kind is not None and kind.type in ("class_specifier", "struct_specifier", "enum_specifier"):
            self._type(kind, scope, ())
        declarators = node.children_by_field_name("declarator")
        if len(declarators) == 1 and _function_declarator(declarators[0]) is not None:
            self._prototype(node, declarators[0], scope)
            return
        for declared in self._statements.declaration(node):
            *outer, declared.name = declared.name.replace(" ", "").split("::")
            self.variables[declared.name].append(((*scope, *outer), declared))

    def _type(self, node: Node, scope: tuple[str, ...], template: tuple[str, ...]) -> None:
        name, body = node.child_by_field_name("name"), node.child_by_field_name("body")
        if body is None:
            return
        if node.type == "enum_specifier":
            self._enumerators(body)
            return
        named = syntax.parts(name) if name is not None else []
        shown = named[-1].name if named else ""
        outer = tuple(part.name for part in named[:-1])
        made = Class(self, shown, (*scope, *outer), line_of(node), self._bases(node), template)
        made.defaults = self._defaults(node.parent) if template else {}
        self.classes[shown].append(made)
        self._members(body, made)

    def _defaults(self, node: Node | None) -> dict[str, Type]:
        listed = node.child_by_field_name("parameters") if node is not None else None
        found = {}
        for child in listed.named_children if listed is not None else ():
            name, default = child.child_by_field_name("name"), child.child_by_field_name("default_type")
            if child.type == "optional_type_parameter_declaration" and name is not None and default is not None:
                found[syntax.text(name)] = self._expressions.type(default)
        return found

    def _enumerators(self, body: Node) -> None:
        names = (one.child_by_field_name("name") for one in syntax.of_type(body, "enumerator"))
        self.enumerators.update(syntax.text(name) for name in names if name is not None)

    def _bases(self, node: Node) -> tuple[Type, ...]:
        bases = (base for clause in syntax.of_type(node, "base_class_clause") for base in clause.named_children)
        skipped = ("access_specifier", "virtual", "comment")
        return tuple(self._expressions.type(base) for base in bases if base.type not in skipped)

    def _members(self, body: Node, cls: Class, template: tuple[str, ...] = ()) -> None:
        inner = (*cls.scope, cls.name)
        for member in body.named_children:
            kind = member.type
            if kind == "field_declaration":
                self._field(member, cls)
            elif kind == "function_definition":
                self._method(member, cls, template)
            elif kind == "declaration":
                declarator = member.child_by_field_name("declarator")
                found = _function_declarator(declarator) if declarator is not None else None
                if found is not None:
                    self._declare_method(member, found, cls, template)
            elif kind == "template_declaration":
                self._members(member, cls, _template_names(member))
            elif kind in _CLASSES:
                self._type(member, inner, template)
            elif kind in ("alias_declaration", "type_definition"):
                self._alias(member, inner, template)
            elif kind == "using_declaration":
                self._using(member, inner)
            elif kind in PREPROCESSED:
                self._members(member, cls)

    def _field(self, node: Node, cls: Class) -> None:
        kind = node.child_by_field_name("type")
        if kind is not None and kind.child_by_field_name("body") is not None:
            self._type(kind, (*cls.scope, cls.name), ())
        static = any(c.type == "storage_class_specifier" and syntax.text(c) == "static" for c in node.children)
        latest: Field | None = None
        for index, child in enumerate(node.children):
            role = node.field_name_for_child(index)
            if role == "declarator":
                found = _function_declarator(child)
                if found is not None and not _is_function_pointer(found):
                    self._declare_method(node, found, cls, ())
                    continue
                name = syntax.declared_name(child)
                if name is not None:
                    latest = Field(
                        syntax.text(name),
                        self._expressions.declared(node, child),
                        None,
                        line_of(child),
                        static,
                    )
                    cls.fields[latest.name] = latest
            elif role == "default_value" and latest is not None:
                latest.value = self._expressions.expression(child)

    def _method(self, node: Node, cls: Class, template: tuple[str, ...]) -> None:
        made = self._made(node, (*cls.scope, cls.name), template)
        if made is not None:
            made.owner = cls
            cls.methods.setdefault(made.name, []).append(made)

    def _declare_method(self, node: Node, declarator: Node, cls: Class, template: tuple[str, ...]) -> None:
        name = syntax.declared_name(declarator)
        if name is None:
            return
        made = Function(
            self,
            syntax.text(name),
            (*cls.scope, cls.name),
            self._expressions.parameters(declarator),
            line_of(node),
            template,
            self._expressions.declared(node, None) if node.child_by_field_name("type") is not None else None,
            cls,
            virtual=_is_virtual(node),
        )
        cls.declared.setdefault(made.name, []).append(made)

    def _prototype(self, node: Node, declarator: Node, scope: tuple[str, ...]) -> None:
        found = _function_declarator(declarator)
        name = syntax.declared_name(found)
        if found is not None and name is not None:
            shown = syntax.simple_name(name)
            parameters = self._expressions.parameters(found)
            kind = self._expressions.declared(node, None)
            self.prototypes[shown].append(Function(self, shown, scope, parameters, line_of(node), (), kind))

    def _function(self, node: Node, scope: tuple[str, ...], template: tuple[str, ...]) -> None:
        kind = node.child_by_field_name("type")
        if kind is not None and kind.type in ("class_specifier", "struct_specifier"):
            self._type(kind, scope, template)
        made = self._made(node, scope, template)
        if made is not None:
            self.functions[made.name].append(made)

    def _made(self, node: Node, scope: tuple[str, ...], template: tuple[str, ...]) -> Function | None:
        declarator = _function_declarator(node.child_by_field_name("declarator"))
        if declarator is None:
            return None
        name = declarator.child_by_field_name("declarator")
        if name is None:
            return None
        named = syntax.parts(name) if name.type != "destructor_name" else []
        shown = named[-1].name if named else syntax.text(name)
        outer = tuple(part.name for part in named[:-1] if part.name)
        kind = node.child_by_field_name("type")
        returns = self._expressions.declared(node, node.child_by_field_name("declarator")) if kind is not None else None
        for trailing in syntax.of_type(declarator, "trailing_return_type")[:1] if kind is None else ():
            returns = self._expressions.type(trailing.named_children[0]) if trailing.named_children else None
        body = node.child_by_field_name("body")
        if body is None:  # a function-try-block
            if syntax.of_type(node, "delete_method_clause", "default_method_clause"):
                return None
            body = next(iter(syntax.of_type(node, "try_statement")), None)
        return Function(
            self,
            shown,
            (*scope, *outer),
            self._expressions.parameters(declarator),
            line_of(declarator),
            template,
            returns,
            virtual=_is_virtual(node),
            source=body,
            initialisers=self._initialisers(node),
        )

    def _initialisers(self, node: Node) -> tuple[Initialiser, ...]:
        clause = next(iter(syntax.of_type(node, "field_initializer_list")), None)
        found = []
        for entry in syntax.of_type(clause, "field_initializer"):
            if not entry.named_children:
                continue
            name = entry.named_children[0]
            given = next(iter(syntax.of_type(entry, "argument_list", "initializer_list")), None)
            listed = given is not None and given.type == "initializer_list"
            arguments = self._expressions.arguments(given)
            found.append(Initialiser(syntax.simple_name(name), arguments, line_of(entry), listed))
        return tuple(found)

    def expand(self, macro: Macro) -> Function:
        """Return a macro as a function whose body is its text: an expression, or statements."""
        if macro.function is not None:
            return macro.function
        body = f"void kg_macro() {{ {macro.text} }}"
        if not _is_statements(macro.text):
            body = f"auto kg_macro() {{ return {macro.text}; }}"
        source = body.encode()
        statements = Statements(Expressions(self), source)
        definition = next(iter(syntax.of_type(syntax.parse(source).root_node, "function_definition")), None)
        block = statements.block(definition.child_by_field_name("body") if definition is not None else None)
        parameters = tuple(Parameter(name, None) for name in macro.parameters or ())
        macro.function = Function(self, macro.name, (), parameters, macro.line, body_made=block)
        return macro.function


def _is_statements(text: str) -> bool:
    stripped = text.strip()
    return ";" in stripped or stripped.startswith(("do ", "do{", "{", "if ", "if(", "static ", "return "))


def _condition(node: Node) -> str:
    found = node.child_by_field_name("condition")
    return syntax.text(found).strip() if found is not None else ""


def _template_names(node: Node) -> tuple[str, ...]:
    listed = node.child_by_field_name("parameters")
    found = []
    for child in listed.named_children if listed is not None else ():
        if child.type in (
            "type_parameter_declaration",
            "optional_type_parameter_declaration",
            "variadic_type_parameter_declaration",
        ):
            name = child.child_by_field_name("name") or next(
                (c for c in child.named_children if c.type == "type_identifier"), None
            )
        elif child.type == "template_template_parameter_declaration":
            name = (
                child.named_children[-1].named_children[0]
                if child.named_children and child.named_children[-1].named_children
                else None
            )
        else:
            name = syntax.declared_name(child.child_by_field_name("declarator"))
        found.append(syntax.text(name) if name is not None else "")
    return tuple(found)


def _is_virtual(node: Node) -> bool:
    if any(c.type in ("virtual", "virtual_function_specifier") for c in node.children):
        return True
    declarator = _function_declarator(node.child_by_field_name("declarator"))
    return bool(syntax.of_type(declarator, "virtual_specifier"))


def _is_function_pointer(declarator: Node) -> bool:
    inner = declarator.child_by_field_name("declarator")
    return inner is not None and inner.type == "parenthesized_declarator"


def _function_declarator(node: Node | None) -> Node | None:
    for _ in range(8):
        if node is None or node.type == "function_declarator":
            return node
        inner = node.child_by_field_name("declarator")
        if inner is None:
            inner = next((c for c in node.named_children if c.type == "function_declarator"), None)
        node = inner
    return None
