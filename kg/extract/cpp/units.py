"""One file of C++: the names that it declares. Declarations and bodies are lowered at the first use."""

from __future__ import annotations

import re
from collections import defaultdict
from typing import TYPE_CHECKING, Any, Final, TypeAlias, cast

from kg.extract.cpp import syntax
from kg.extract.cpp.expressions import PREPROCESSED, Expressions
from kg.extract.cpp.macros import CONTINUED, Macro, add_inner_macros
from kg.extract.cpp.preparing import prepared
from kg.extract.cpp.statements import Statements
from kg.extract.cpp.syntax import line_of
from kg.symbolic.form import Block, Class, Declare, Expression, Field, Function, Initialiser, Parameter, Type, Unit
from kg.symbolic.reach import GIVES_NODE

if TYPE_CHECKING:
    from collections.abc import Collection

    from tree_sitter import Node

    from kg.corpus.files import FilePath


def included(source: bytes) -> dict[str, int]:
    """Return the paths of the `#include` lines of a file, in order, with the first line of each, from 1."""
    lines: dict[str, int] = {}
    line, counted = 1, 0
    position = source.find(b"#")
    while position >= 0:
        end = source.find(b"\n", position)
        directive = source[position + 1 : end if end >= 0 else len(source)].strip()
        begin = source.rfind(b"\n", 0, position) + 1
        if directive.startswith(b"include") and not source[begin:position].strip():
            path = directive.removeprefix(b"include").strip()
            closing = path.find(b">" if path.startswith(b"<") else b'"', 1)
            if path[:1] in (b"<", b'"') and closing > 0:
                line, counted = line + source.count(b"\n", counted, position), position
                lines.setdefault(path[1:closing].decode("utf-8", "replace").strip(), line)
        position = source.find(b"#", max(end, position + 1)) if end >= 0 else -1
    return lines


def words_of(code: str) -> frozenset[str]:
    """Return the identifiers in some code, and `GIVES_NODE` if it creates an object that gets a node or a handle."""
    code = _without_comments(code)
    words = frozenset(_WORD.findall(code))
    return words | {GIVES_NODE} if _GIVING.search(code) else words


def _without_comments(code: str) -> str:
    """Return some code with a space for each comment."""
    return COMMENT.sub(lambda match: match[1] or " ", code) if "/" in code else code


def assigned_in(code: str) -> frozenset[str]:
    """Return the names that some code assigns, increments, or changes by a method of containers and pointers."""
    return frozenset(match[1] or match[2] for match in _ASSIGNED.finditer(code))


def split_name(name: str) -> list[str]:
    """Return the parts of a qualified name, at least one, each with its template arguments."""
    return _PART.findall(name.replace(" ", "")) or [name]


def spelling(given: Node | None) -> str:
    """Return template arguments as a part of a name: without spaces."""
    return "".join(syntax.text(given).split()) if given is not None else ""


_Scope: TypeAlias = tuple[str, ...]
_CONTAINERS: Final = PREPROCESSED | {"translation_unit", "linkage_specification", "declaration_list"}
_INTEGER: Final = re.compile(r"(-?(?:0[xX][0-9a-fA-F]+|0|[1-9]\d*))[uUlL]*")
_ADAPTER: Final = "RCLCPP_USING_CUSTOM_TYPE_AS_ROS_MESSAGE_TYPE"
_POINTERS: Final = frozenset({"SharedPtr", "UniquePtr", "WeakPtr", "ConstSharedPtr", "Ptr", "ConstPtr"})
"""Names of aliases in a class for pointers to it."""
_PART: Final = re.compile(r"(?:[^:<]|<(?:[^<>]|<(?:[^<>]|<[^<>]*>)*>)*>)+")
_WORD: Final = re.compile(r"[A-Za-z_]\w*")
_GIVING: Final = re.compile(
    r"(?:\bmake_(?:shared|unique)\s*<[^;()]*>|\bnew\s+[\w:]+|::\w+(?:<[^;()]*>)?\s+\w+)\s*[({](?:[^;(){}]*,)?\s*"
    r"(?:\*|this->)?(?:\w*[Nn]ode_?|\w*nh_?|\w*node_?handle_?|shared_from_this\(\))\s*[,)}]"
)
_ASSIGNED: Final = re.compile(
    r"\b([A-Za-z_]\w*)(?:\[[^\]]*\])?\s*(?:(?:[-+*/%|&^]|<<|>>)?=(?!=)|\+\+|--|"
    r"(?:\.|->)\s*(?:reset|swap|push_\w+|emplace\w*|insert\w*|pop_\w+|erase|clear|resize|assign|store|append)\b)"
    r"|(?:\+\+|--)\s*(?:\w+(?:\.|->))*([A-Za-z_]\w*)"
)
COMMENT: Final = re.compile(r"""("(?:[^"\\]|\\.)*"|'(?:[^'\\]|\\.)*')|//[^\n]*|/\*.*?\*/""", re.DOTALL)
"""A comment, or a literal that may look like one."""
_QUALIFIER: Final = re.compile(r"[A-Za-z_]\w*(?:\s*::\s*[A-Za-z_]\w*)*")
"""A macro with such a text can be another name of a type, or, in front of `::`, of a namespace."""
_NAMESPACE_ALIAS: Final = re.compile(rb"\bnamespace\s+(\w+)\s*=\s*([\w:\s]+?)\s*;")
_DECLARED: Final = re.compile(rb"\b(?:(?:class|struct)\s+|[A-Z_]+_FORWARD\s*\(\s*)(\w+)\s*[;)]")
"""Declarations of classes without their bodies, also by macros such as `MOVEIT_CLASS_FORWARD`."""


_DECLARES: Final = re.compile(r"(?:const\s+|static\s+)*[\w:]+(?:<[^;=]*>)?[\s*&]+\w+\s*=[^=]")
"""The begin of a declaration with a value."""
_PURE: Final = re.compile(rb"\Avirtual\b[^{]*=\s*0\s*;\Z")


class CppFunction(Function):
    """A function of a file. Slots of its declarator are filled at the first use of one of them."""

    __slots__ = ("_assigned", "_words", "declarator", "given", "node")

    def __init__(self, unit: CppUnit, name: str, scope: _Scope, nodes: tuple[Node, Node], template: _Scope) -> None:
        """Take the nodes of the declaration and its declarator."""
        self.unit, self.name, self.scope, self.template, self.owner = unit, name, scope, template, None
        self.node, self.declarator = nodes
        self.line = line_of(self.declarator if self.node.type == "function_definition" else self.node)
        self.outer, self.static, self.marks, self.source, self.lowered_body = (), False, frozenset(), None, None
        self.pattern, self.within = (), ()
        self.given = ""
        """The text of `within`."""
        self._words: frozenset[str] | None = None
        self._assigned: frozenset[str] | None = None

    @property
    def code(self) -> str:
        """The code after its declarator: initialisers and the body."""
        source = cast("CppUnit", self.unit).source
        return source[self.declarator.end_byte : self.node.end_byte].decode("utf-8", "replace")

    @property
    def words(self) -> frozenset[str]:
        """The identifiers in its code."""
        if self._words is None:
            self._words = words_of(self.code)
        return self._words

    @property
    def assigned(self) -> frozenset[str]:
        """The names that it changes; see `assigned_in`."""
        if self._assigned is None:
            self._assigned = assigned_in(self.code)
        return self._assigned

    def __getattr__(self, name: str) -> Any:
        unit = cast("CppUnit", self.unit)
        if name == "virtual":
            self.virtual = _is_virtual(self.node)
        elif name == "initialisers":
            self.initialisers = unit.initialisers(self.node)
        elif name == "parameters":
            self.parameters = unit.expressions.parameters(self.declarator)
        elif name == "returns":
            self.returns = unit.returned(self)
        elif name == "defaults":
            self.defaults = unit.defaults(self.node.parent) if self.template else {}
        else:
            raise AttributeError(name)
        return getattr(self, name)


class CppClass(Class):
    """A class of a file. Slots of its bases and members are filled at the first use of one of them."""

    __slots__ = ("_words", "given", "node")

    def __init__(self, unit: CppUnit, scope: _Scope, node: Node, template: _Scope) -> None:
        name = node.child_by_field_name("name")
        *outer, (self.name, given) = (syntax.parts(name) if name is not None else []) or [syntax.Part("")]
        self.scope = (*scope, *(part.name for part in outer))
        self.unit, self.template, self.line = unit, template, line_of(node)
        self.node, self.derived, self.body = node, (), None
        self.given = spelling(given)
        """The template arguments of a specialisation, as written."""
        self.pattern = unit.expressions.template(given)
        self._words: frozenset[str] | None = None

    @property
    def inside(self) -> _Scope:
        """The scope of its members; that of a specialisation has its arguments."""
        return (*self.scope, self.name + self.given)

    @property
    def words(self) -> frozenset[str]:
        """The identifiers in what the creation of an object runs: its bases, and the types and values of its fields."""
        if self._words is None:
            body = self.node.child_by_field_name("body")
            values = (one.child_by_field_name("default_value") for one in syntax.of_type(body, "field_declaration"))
            code = " ".join(syntax.text(value) for value in values if value is not None)
            types = [one.type for one in self.fields.values() if one.type is not None and not one.static]
            kinds = [*self.bases, *(kind for kind in types if not kind.pointer and not kind.reference)]
            self._words = words_of(code).union(*(kind.names for kind in kinds if kind.name not in _POINTERS))
        return self._words

    @property
    def public(self) -> frozenset[str]:
        """The names of its public methods."""
        body = self.node.child_by_field_name("body")
        names, shown = set(), self.node.type == "struct_specifier"
        for member in body.named_children if body is not None else ():
            if member.type == "access_specifier":
                shown = syntax.text(member).startswith("public")
            declarator = _function_declarator(member.child_by_field_name("declarator")) if shown else None
            name = syntax.declared_name(declarator)
            if name is not None:
                names.add(syntax.text(name))
        return frozenset(names)

    @property
    def abstract(self) -> bool:
        """Whether it leaves methods to classes that derive from it: `= 0`."""
        body = self.node.child_by_field_name("body")
        return body is not None and any(_PURE.search(member.text or b"") for member in body.named_children)

    def __getattr__(self, name: str) -> Any:
        unit = cast("CppUnit", self.unit)
        if name in ("fields", "methods", "declared"):
            self.fields, self.methods, self.declared = {}, {}, {}
            unit.members(self.node.child_by_field_name("body"), self, ())
        elif name == "bases":
            self.bases = unit.bases(self.node)
        elif name == "defaults":
            self.defaults = unit.defaults(self.node.parent) if self.template else {}
        else:
            raise AttributeError(name)
        return getattr(self, name)


class CppUnit(Unit):
    """The declarations of one file, by name."""

    def __init__(self, key: FilePath, source: bytes, ros: int, absent: frozenset[str]) -> None:
        self.key = key
        self.ros, self.absent = ros, absent
        self.source = prepared(source, ros, absent)
        self.classes: dict[str, list[Class]] = defaultdict(list)
        self.functions: dict[str, list[Function]] = defaultdict(list)
        """Functions with bodies at namespace scope, also methods, by their last name."""
        self.methods: dict[str, list[Function]] = defaultdict(list)
        """Those among them with a qualified name, by its last scope."""
        self.prototypes: dict[str, list[Function]] = defaultdict(list)
        self.inline: dict[str, set[str]] = defaultdict(set)
        """Methods that are defined in their class, with the names of these classes."""
        self._aliases: dict[str, list[tuple[_Scope, Node | Type, _Scope]]] = defaultdict(list)
        self._variables: dict[str, list[tuple[_Scope, Node]]] = defaultdict(list)
        self.external: set[str] = set()
        """Variables that it declares as defined in another file."""
        self._lowered_aliases: dict[str, list[tuple[_Scope, Type, _Scope]]] = {}
        self._lowered_variables: dict[str, list[tuple[_Scope, Declare]]] = {}
        self.macros: dict[str, Macro] = {}
        self.namespaces: dict[str, list[tuple[_Scope, _Scope]]] = defaultdict(list)
        """Other names of namespaces: the scope of each alias, and the namespace as written."""
        self.enumerators: dict[str, int | None] = {}
        """The constants of enumerations with their numbers, None if unknown or several of that name differ."""
        self._declared: frozenset[bytes] | None = None
        self.registrations: list[Node] = []
        self.adapted: dict[str, list[tuple[_Scope, Type]]] = defaultdict(list)
        """Types that stand for a message, by their last name: their scope as written, and the message."""
        self.expressions = Expressions(self)
        self._statements = Statements(self.expressions, self.source)
        self._read(syntax.parse(self.source).root_node, ())
        for name, target in _NAMESPACE_ALIAS.findall(self.source):
            if name.decode() not in self.namespaces:  # in the body of a function, which is not read before it runs
                self._add_namespace(name, target, ())
        add_inner_macros(self)
        self.includes = included(self.source)
        """The paths that it includes, as written, with their lines."""
        self.names: dict[str, Collection[str]] = {
            "class": self.classes,
            "function": self.functions,
            "inline": self.inline,
            "prototype": self.prototypes,
            "alias": self._aliases,
            "adapted": self.adapted,
            "namespace": self.namespaces,
            "variable": self._variables,
            "macro": self.macros,
            "enumerator": self.enumerators,
            "include": {path.rpartition("/")[2] for path in self.includes},
        }
        """All names that the file declares, except for members that are not types, and those of files it includes."""
        self.stand_for = [(name, words_of(macro.text)) for name, macro in self.macros.items()]
        """The words that its macros, and its other names of types that are no pointers, stand for."""
        for name, given in self._aliases.items():
            if name not in _POINTERS:
                written = (syntax.text(kind) for _, kind, _ in given if not isinstance(kind, Type))
                self.stand_for += [(name, words_of(text)) for text in written]

    def declares(self, name: str) -> bool:
        """Return whether it declares a class of a name without its body."""
        if self._declared is None:
            self._declared = frozenset(_DECLARED.findall(self.source))
        return name.encode() in self._declared

    def aliases(self, name: str) -> list[tuple[_Scope, Type, _Scope]]:
        """Return the types that `using` or `typedef` gives a name: scope, type, template parameters."""
        lowered = self._lowered_aliases.get(name)
        if lowered is None:
            lowered = self._lowered_aliases[name] = [
                (scope, kind if isinstance(kind, Type) else self.expressions.type(kind), template)
                for scope, kind, template in self._aliases.get(name, ())
            ]
        return lowered

    def variables(self, name: str) -> list[tuple[_Scope, Declare]]:
        """Return the variables of a name at namespace scope, and static members, with their scopes."""
        lowered = self._lowered_variables.get(name)
        if lowered is None:
            lowered = self._lowered_variables[name] = []
            for scope, node in self._variables.get(name, ()):
                for declared in self._statements.declaration(node):
                    *outer, last = split_name(declared.name)
                    if outer and outer[-1].endswith(">") and self._is_general(node, outer[-1]):
                        outer[-1] = outer[-1].partition("<")[0]
                    if last == name:
                        declared.name = last
                        lowered.append(((*scope, *outer), declared))
        return lowered

    def _is_general(self, node: Node, owner: str) -> bool:
        """Return whether a static member is that of all instances of a template: its arguments are the parameters."""
        around = node.parent
        names = _template_names(around) if around is not None and around.type == "template_declaration" else ()
        return owner.partition("<")[2] == f"{','.join(names)}>"

    def written(self, name: str) -> Type:
        """Return the type that a text names."""
        tree = syntax.parse(f"using kg = {name};".encode())
        return self.expressions.type(tree.root_node.named_children[0].child_by_field_name("type"))

    # Names

    def _read(self, node: Node, scope: _Scope) -> None:
        for child in node.named_children:
            self._declaration(child, scope, ())

    def _declaration(self, node: Node, scope: _Scope, template: _Scope) -> None:
        kind = node.type
        if kind == "function_definition":
            self._function(node, scope, template)
        elif kind == "namespace_definition":
            name, body = node.child_by_field_name("name"), node.child_by_field_name("body")
            inner = tuple(syntax.text(name).split("::")) if name is not None else ()
            if body is not None:
                self._read(body, (*scope, *(part.strip() for part in inner)))
        elif kind in syntax.CLASSES:
            self._type(node, scope, template)
        elif kind == "template_declaration":
            names = (*template, *_template_names(node))
            for child in node.named_children:
                if child.type != "template_parameter_list":
                    self._declaration(child, scope, names)
        elif kind == "declaration":
            self._variable(node, scope)
        elif kind in ("alias_declaration", "type_definition"):
            self._alias(node, scope, template)
        elif kind == "using_declaration":
            self._using(node, scope)
        elif kind == "namespace_alias_definition":
            for name, target in _NAMESPACE_ALIAS.findall(node.text or b""):
                self._add_namespace(name, target, scope)
        elif kind == "preproc_def":
            self._macro(node, None)
        elif kind == "preproc_function_def":
            listed = node.child_by_field_name("parameters")
            self._macro(node, tuple(syntax.text(c) for c in listed.named_children) if listed is not None else ())
        elif kind in _CONTAINERS:
            self._read(node, scope)
        elif kind == "expression_statement":
            for child in node.named_children:
                if child.type == "call_expression":
                    self.registrations.append(child)
                    self._adapter(child)

    def _add_namespace(self, name: bytes, target: bytes, scope: _Scope) -> None:
        names = tuple(part for part in re.sub(r"\s", "", target.decode()).split("::") if part)
        if (scope, names) not in self.namespaces[name.decode()]:
            self.namespaces[name.decode()].append((scope, names))

    def _adapter(self, call: Node) -> None:
        """Read the macro that states which message a type stands for."""
        given = syntax.arguments(call.child_by_field_name("arguments"))
        if len(given) == len(("type", "message")) and syntax.text(call).startswith(_ADAPTER):
            *scope, name = [part.name for part in syntax.parts(given[0]) if part.name]
            self.adapted[name].append((tuple(scope), self.expressions.type(given[1])))

    def _macro(self, node: Node, parameters: _Scope | None) -> None:
        name, value = node.child_by_field_name("name"), node.child_by_field_name("value")
        if name is not None and value is not None:
            text = _without_comments(CONTINUED.sub(" ", syntax.text(value))).strip()
            shown = syntax.text(name)
            self.macros[shown] = Macro(self, shown, parameters, text, line_of(node))
            if parameters is None and _QUALIFIER.fullmatch(text):
                self._add_namespace(shown.encode(), text.encode(), ())
                self._aliases[shown].append(((), Type(tuple(re.sub(r"\s", "", text).split("::"))), ()))

    def _using(self, node: Node, scope: _Scope) -> None:
        named = syntax.of_type(node, "identifier", "qualified_identifier", "namespace_identifier")
        if not named:
            return
        names = tuple(part.name for part in syntax.parts(named[0]) if part.name)
        if any(c.type == "namespace" for c in node.children):
            self.uses = (*self.uses, names)
        elif len(names) > 1 and names[-1] != names[-2]:
            self._aliases[names[-1]].append((scope, Type(names), ()))

    def _alias(self, node: Node, scope: _Scope, template: _Scope) -> None:
        kind = node.child_by_field_name("type")
        if node.type == "alias_declaration":
            declarators = [node.child_by_field_name("name")]
        else:
            declarators = [*node.children_by_field_name("declarator")]
        if kind is not None and kind.child_by_field_name("body") is not None:
            self._type(kind, scope, template)
        for declarator in declarators:
            name = syntax.declared_name(declarator)
            if declarator is not None and name is not None and kind is not None:
                pointer = declarator.type == "pointer_declarator"
                meant = self.expressions.type(kind, pointer=True) if pointer else kind
                self._aliases[syntax.text(name)].append((scope, meant, template))

    def _variable(self, node: Node, scope: _Scope) -> None:
        kind = node.child_by_field_name("type")
        if kind is not None and kind.type in ("class_specifier", "struct_specifier", "enum_specifier"):
            self._type(kind, scope, ())
        declarators = node.children_by_field_name("declarator")
        declarator = _function_declarator(declarators[0]) if len(declarators) == 1 else None
        if declarator is not None:
            name = syntax.declared_name(declarator)
            if name is not None:
                shown = syntax.simple_name(name)
                self.prototypes[shown].append(CppFunction(self, shown, scope, (node, declarator), ()))
            return
        external = any(c.type == "storage_class_specifier" and syntax.text(c) == "extern" for c in node.children)
        names = (syntax.declared_name(one) for one in declarators)
        for shown in dict.fromkeys(syntax.text(name) for name in names if name is not None):
            last = split_name(shown)[-1]
            self._variables[last].append((scope, node))
            if external:
                self.external.add(last)

    def _type(self, node: Node, scope: _Scope, template: _Scope) -> None:
        body = node.child_by_field_name("body")
        if body is None:
            return
        if node.type == "enum_specifier":
            for enumerator, number in _enumerated(body).items():
                self.enumerators[enumerator] = number if self.enumerators.get(enumerator, number) == number else None
            return
        cls = CppClass(self, scope, node, template)
        self.classes[cls.name].append(cls)
        self._nested(body, cls.inside, ())

    def _nested(self, body: Node, scope: _Scope, template: _Scope) -> None:
        """Read the types that a class declares inside of it."""
        for member in body.named_children:
            kind = member.type
            if kind == "field_declaration":
                inner = member.child_by_field_name("type")
                if inner is not None and inner.type in syntax.CLASSES:
                    self._type(inner, scope, ())
            elif kind == "function_definition":
                name = syntax.declared_name(member.child_by_field_name("declarator"))
                if name is not None:
                    self.inline[syntax.text(name)].add(scope[-1].partition("<")[0])
            elif kind == "template_declaration":
                self._nested(member, scope, _template_names(member))
            elif kind in syntax.CLASSES:
                self._type(member, scope, template)
            elif kind in ("alias_declaration", "type_definition"):
                self._alias(member, scope, template)
            elif kind == "using_declaration":
                self._using(member, scope)
            elif kind in PREPROCESSED:
                self._nested(member, scope, ())

    def _function(self, node: Node, scope: _Scope, template: _Scope) -> None:
        kind = node.child_by_field_name("type")
        if kind is not None and kind.type in ("class_specifier", "struct_specifier"):
            self._type(kind, scope, template)
        function = self._defined(node, scope, template, None)
        if function is not None:
            self.functions[function.name].append(function)
            if len(function.scope) > len(scope):
                self.methods[function.scope[-1]].append(function)

    def _defined(self, node: Node, scope: _Scope, template: _Scope, owner: Class | None) -> Function | None:
        declarator = _function_declarator(node.child_by_field_name("declarator"))
        name = declarator.child_by_field_name("declarator") if declarator is not None else None
        if declarator is None or name is None:
            return None
        named = syntax.parts(name) if name.type != "destructor_name" else []
        shown = named[-1].name if named else syntax.text(name)
        body = node.child_by_field_name("body")
        if body is None:  # a function-try-block
            if syntax.of_type(node, "delete_method_clause", "default_method_clause"):
                return None
            body = next(iter(syntax.of_type(node, "try_statement")), None)
        inner = (*scope, *(part.name for part in named[:-1] if part.name))
        given = syntax.arguments(named[-2].template) if len(named) > 1 else []
        outer = tuple(name for name in map(syntax.text, given) if name in template)
        if len(outer) == len(given):
            template = tuple(name for name in template if name not in outer)
        function = CppFunction(self, shown, inner, (node, declarator), template)
        function.owner, function.source = owner, body
        if len(outer) == len(given):
            function.outer = outer
        else:
            function.within = self.expressions.template(named[-2].template)
            function.given = spelling(named[-2].template)
        function.pattern = self.expressions.template(named[-1].template) if named else ()
        return function

    def code(self, function: Function) -> str:
        """Return the text of the body of a function of this file; empty if it has none."""
        body = cast("Node | None", function.source)
        return self.source[body.start_byte : body.end_byte].decode("utf-8", "replace") if body is not None else ""

    # What is lowered at the first use

    def lower_body(self, function: Function) -> Block:
        """Return the statements of a function of this file."""
        return self._statements.block(cast("Node | None", function.source))

    def members(self, body: Node | None, cls: Class, template: _Scope) -> None:
        """Add the fields and methods in the body of a class, and in `template` declarations and branches of it."""
        inner = cls.inside
        for member in body.named_children if body is not None else ():
            kind = member.type
            if kind == "field_declaration":
                self._field(member, cls)
            elif kind == "function_definition":
                method = self._defined(member, inner, template, cls)
                if method is not None:
                    cls.methods.setdefault(method.name, []).append(method)
            elif kind == "declaration":
                declarator = _function_declarator(member.child_by_field_name("declarator"))
                if declarator is not None:
                    self._declare_method(member, declarator, cls, template)
            elif kind == "template_declaration":
                self.members(member, cls, _template_names(member))
            elif kind in PREPROCESSED:
                self.members(member, cls, ())

    def _field(self, node: Node, cls: Class) -> None:
        storage = {syntax.text(child) for child in node.children if child.type == "storage_class_specifier"}
        latest: Field | None = None
        for index, child in enumerate(node.children):
            role = node.field_name_for_child(index)
            if role == "declarator":
                declarator = _function_declarator(child)
                if declarator is not None and not syntax.is_function_pointer(declarator):
                    self._declare_method(node, declarator, cls, ())
                    continue
                name = syntax.declared_name(child)
                if name is not None:
                    kind = self.expressions.declared(node, child)
                    latest = Field(
                        syntax.text(name), kind, None, line_of(child), "static" in storage, "inline" in storage
                    )
                    cls.fields[latest.name], target = latest, child
            elif role == "default_value" and latest is not None:
                given = latest.type
                if latest.static and given is not None and child.named_child_count == 1:  # `static constexpr int A{1};`
                    latest.value = self._statements.begin(child, target, given, latest.line)
                else:
                    latest.value = self.expressions.expression(child)

    def _declare_method(self, node: Node, declarator: Node, cls: Class, template: _Scope) -> None:
        name = syntax.declared_name(declarator)
        if name is not None:
            method = CppFunction(self, syntax.text(name), cls.inside, (node, declarator), template)
            method.owner = cls
            cls.declared.setdefault(method.name, []).append(method)

    def bases(self, node: Node) -> tuple[Type, ...]:
        """Return the bases of a class."""
        bases = (base for clause in syntax.of_type(node, "base_class_clause") for base in clause.named_children)
        skipped = ("access_specifier", "virtual", "comment")
        return tuple(self.expressions.type(base) for base in bases if base.type not in skipped)

    def defaults(self, node: Node | None) -> dict[str, Type | Expression]:
        """Return the defaults of the parameters of a template."""
        listed = node.child_by_field_name("parameters") if node is not None else None
        defaults: dict[str, Type | Expression] = {}
        for child in listed.named_children if listed is not None else ():
            name, default = child.child_by_field_name("name"), child.child_by_field_name("default_type")
            if child.type == "optional_type_parameter_declaration" and name is not None and default is not None:
                defaults[syntax.text(name)] = self.expressions.type(default)
            elif child.type == "optional_parameter_declaration":
                name = syntax.declared_name(child.child_by_field_name("declarator"))
                value = child.child_by_field_name("default_value")
                if name is not None and value is not None:
                    defaults[syntax.text(name)] = self.expressions.expression(value)
        return defaults

    def returned(self, function: CppFunction) -> Type | None:
        """Return the type that a function returns, as written; None for a constructor."""
        node, definition = function.node, function.node.type == "function_definition"
        if node.child_by_field_name("type") is not None or (not definition and function.owner is None):
            return self.expressions.declared(node, node.child_by_field_name("declarator") if definition else None)
        trailing = next(iter(syntax.of_type(function.declarator, "trailing_return_type")), None) if definition else None
        return self.expressions.type(trailing.named_children[0]) if trailing and trailing.named_children else None

    def initialisers(self, node: Node) -> tuple[Initialiser, ...]:
        """Return the initialisers of a constructor."""
        clause = next(iter(syntax.of_type(node, "field_initializer_list")), None)
        initialisers = []
        for entry in syntax.of_type(clause, "field_initializer"):
            if not entry.named_children:
                continue
            name = entry.named_children[0]
            given = next(iter(syntax.of_type(entry, "argument_list", "initializer_list")), None)
            listed = given is not None and given.type == "initializer_list"
            arguments = self.expressions.arguments(given)
            initialisers.append(Initialiser(syntax.simple_name(name), arguments, line_of(entry), listed))
        return tuple(initialisers)

    def expand(self, macro: Macro, line: int, given: tuple[str, ...] = ()) -> Function:
        """Return a macro as a function at the line that uses it. Its text is an expression or statements.

        `given` are arguments that become a part of the text.
        """
        key = (line, given)
        if key in macro.functions:
            return macro.functions[key]
        text = macro.filled(given) if given else macro.text
        body = f"void kg_macro() {{ {text} }}"
        if not _is_statements(text):
            body = f"auto kg_macro() {{ return {text}; }}"
        source = b"\n" * (line - 1) + body.encode()  # so that what it declares is at the line that uses it
        statements = Statements(Expressions(self), source)
        definition = next(iter(syntax.of_type(syntax.parse(source).root_node, "function_definition")), None)
        block = statements.block(definition.child_by_field_name("body") if definition is not None else None)
        parameters = tuple(Parameter(name, None) for name in macro.parameters or ())
        macro.functions[key] = Function(self, macro.name, (), parameters, macro.line, lowered_body=block)
        return macro.functions[key]


def _is_statements(text: str) -> bool:
    stripped = text.strip()
    declares = _DECLARES.match(stripped) is not None
    return declares or ";" in stripped or stripped.startswith(("do ", "do{", "{", "if ", "if(", "static ", "return "))


def _template_names(node: Node) -> tuple[str, ...]:
    listed = node.child_by_field_name("parameters")
    names = []
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
        names.append(syntax.text(name) if name is not None else "")
    return tuple(names)


def _enumerated(body: Node) -> dict[str, int | None]:
    """Return the constants of an enumeration with their numbers, None where its text does not give the number."""
    values: dict[str, int | None] = {}
    following: int | None = 0
    for child in body.named_children:
        name = child.child_by_field_name("name") if child.type == "enumerator" else None
        if name is None:
            following = following if child.type == "comment" else None
            continue
        value = child.child_by_field_name("value")
        if value is not None:
            written = _INTEGER.fullmatch(syntax.text(value).replace("'", ""))
            following = int(written[1], 0) if written is not None else None
        values[syntax.text(name)] = following
        following = following + 1 if following is not None else None
    return values


def _is_virtual(node: Node) -> bool:
    if any(c.type in ("virtual", "virtual_function_specifier") for c in node.children):
        return True
    declarator = _function_declarator(node.child_by_field_name("declarator"))
    return bool(syntax.of_type(declarator, "virtual_specifier"))


def _function_declarator(node: Node | None) -> Node | None:
    for _ in range(8):
        if node is None or node.type == "function_declarator":
            return node
        inner = node.child_by_field_name("declarator")
        if inner is None:
            inner = next((c for c in node.named_children if c.type == "function_declarator"), None)
        node = inner
    return None
