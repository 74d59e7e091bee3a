"""Where functions are called and objects are made, in the reached code of a program."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, Final

from kg.extract.cpp import syntax
from kg.extract.cpp.context import Site
from kg.extract.cpp.unit import Expr

if TYPE_CHECKING:
    from collections.abc import Iterator

    from tree_sitter import Node

    from kg.extract.cpp.program import Program
    from kg.extract.cpp.unit import Class, Function, Unit

__all__ = ["MAKERS", "Sites", "accepts", "call_around", "declarator_arguments"]

MAKERS: Final = frozenset({"make_shared", "make_unique", "allocate_shared", "make_optional", "make_boost_shared"})
_TEXTS: Final = frozenset({"string_literal", "concatenated_string", "raw_string_literal"})
_NO_TEXTS: Final = frozenset({"number_literal", "null", "true", "false", "lambda_expression", "this"})
_NUMBERS: Final = frozenset({"bool", "int", "double", "float", "size_t", "uint32_t", "int64_t", "unsigned"})
_BINDERS: Final = frozenset({"bind", "thread", "async", "bind_front"})
_NAMING: Final = frozenset(
    {
        "qualified_identifier",
        "template_function",
        "template_method",
        "dependent_name",
        "template_type",
        "type_descriptor",
    }
)


def call_around(node: Node) -> Node | None:
    """Return the call whose function the name `node` is."""
    inner = node
    for parent in syntax.outward(node, 10):
        if parent.type == "call_expression":
            function = parent.child_by_field_name("function")
            return parent if function is not None and function.id == inner.id else None
        if parent.type == "field_expression":
            field = parent.child_by_field_name("field")
            if field is None or field.id != inner.id:
                return None
        elif parent.type not in _NAMING or _is_argument(parent, inner):
            return None
        inner = parent
    return None


def _is_argument(parent: Node, inner: Node) -> bool:
    scope = parent.child_by_field_name("scope")
    return scope is not None and scope.id == inner.id


def declarator_arguments(unit: Unit, declarator: Node) -> list[Node] | None:
    """Return what a declared variable is constructed from; None where it is no construction."""
    if declarator.type == "init_declarator":
        value = declarator.child_by_field_name("value")
        if value is not None and value.type in ("argument_list", "initializer_list"):
            return syntax.arguments(value)
        return [value] if value is not None else []
    if declarator.type == "function_declarator":
        parameters = declarator.child_by_field_name("parameters")
        return unit.reparse(parameters) if parameters is not None and parameters.named_children else None
    return [] if declarator.type in ("identifier", "field_identifier") else None


class Sites:
    """The call sites of functions and the construction sites of classes."""

    def __init__(self, program: Program) -> None:
        self._program = program
        self._calls: dict[Function, list[Site]] = {}
        self._called: dict[Function, bool] = {}
        self._constructions: dict[Class, list[Site]] = {}

    def calls(self, function: Function) -> list[Site]:
        """Return the calls in reached code that may be calls of `function`, by name and number of arguments."""
        if function not in self._calls:
            self._calls[function] = list(self._find_calls(function))
        return self._calls[function]

    def is_called(self, function: Function) -> bool:
        """Tell whether something that is reached calls a reached function, with that number of arguments, or takes it.

        Entries, constructors and what a base class may call count as called.
        """
        if function not in self._called:
            program = self._program
            uses = (node for _, node in program.sites(function.name) if not _declares(node))
            self._called[function] = (
                program.is_entry(function)
                or bool(self.calls(function))
                or any(call_around(node) is None for node in uses)
            )
        return self._called[function]

    def constructions(self, cls: Class) -> list[Site]:
        """Return where reached code makes objects of a class, as itself or as the base of another."""
        if cls not in self._constructions:
            self._constructions[cls] = list(self._find_constructions(cls))
        return self._constructions[cls]

    def _find_calls(self, function: Function) -> Iterator[Site]:
        owner = self._program.owner(function)
        for unit, node in self._program.sites(function.name):
            call = call_around(node)
            found = _site(unit, call, call) if call is not None else _bound(unit, node, method=owner is not None)
            if found is not None and fits(function, len(found.arguments)) and self._plausible(unit, call, owner):
                yield found

    def _plausible(self, unit: Unit, call: Node | None, owner: Class | None) -> bool:
        """Tell whether an unqualified call can mean a method of `owner`, or a free function if that is None."""
        function = call.child_by_field_name("function") if call is not None else None
        if function is None:
            return True
        if function.type == "field_expression":
            return owner is not None
        around = unit.function_at(function.start_byte)
        caller = self._program.owner(around) if around is not None else unit.class_at(function.start_byte)
        if owner is None or function.type == "qualified_identifier":
            return True
        if caller is None:
            return False
        return any(cls is owner for cls in self._program.family(caller)) or any(
            cls is caller for cls in self._program.family(owner)
        )

    def _find_constructions(self, cls: Class) -> Iterator[Site]:
        found = False
        for unit, node in self._program.sites(cls.name):
            for site in self.constructed_at(unit, node):
                found = True
                yield site
        for site in self._under_other_names(cls):
            found = True
            yield site
        for derived in () if found else self._program.derived(cls):
            if not any(method.name == derived.name for method in self._program.methods(derived)):
                yield from self.constructions(derived)

    def _under_other_names(self, cls: Class) -> Iterator[Site]:
        """Yield the constructions of a class that name it by an alias, which may hold its template arguments."""
        for home in tuple(self._program.units.values()):
            for alias, kinds in home.aliases.items():
                for kind in kinds:
                    if alias == cls.name or syntax.simple_name(kind) != cls.name:
                        continue
                    template = tuple(Expr.of(home, argument) for argument in syntax.template_arguments(_bare(kind)))
                    for unit, node in self._program.sites(alias):
                        for site in self.constructed_at(unit, node):
                            yield replace(site, template=template or site.template)

    def constructed_at(self, unit: Unit, node: Node) -> Iterator[Site]:
        """Yield the constructions that the name of a type stands in; `where` of a site is the type."""
        inner, template = node, tuple[Expr, ...]()
        for parent in syntax.outward(node, 8):
            if parent.type in ("template_type", "template_method", "template_function"):
                given = parent.child_by_field_name("arguments")
                if given is not None and given.id != inner.id:
                    template = tuple(Expr.of(unit, argument) for argument in syntax.arguments(given))
            elif parent.type == "template_argument_list":
                yield from _made(unit, parent, inner, template)
                return
            elif parent.type not in ("qualified_identifier", "type_descriptor"):
                yield from self._constructed_by(unit, parent, inner, template)
                return
            elif _is_argument(parent, inner):
                yield from _factory(unit, parent, inner, template)
                return
            inner = parent

    def _constructed_by(self, unit: Unit, parent: Node, inner: Node, template: tuple[Expr, ...]) -> Iterator[Site]:
        kind = parent.type
        where = Expr.of(unit, inner)
        if kind in ("declaration", "field_declaration"):
            for declarator in parent.children_by_field_name("declarator"):
                yield from self._declared(unit, declarator, where, template, member=kind == "field_declaration")
        elif kind in ("new_expression", "call_expression"):
            given = syntax.arguments(parent.child_by_field_name("arguments"))
            yield Site(where, tuple(Expr.of(unit, argument) for argument in given), template)
        elif kind in ("field_initializer", "compound_literal_expression"):
            given = syntax.arguments(parent.named_children[-1])
            yield Site(where, tuple(Expr.of(unit, argument) for argument in given), template)

    def _declared(
        self, unit: Unit, declarator: Node, where: Expr, template: tuple[Expr, ...], *, member: bool
    ) -> Iterator[Site]:
        if member:
            name = syntax.declared_name(declarator)
            cls = unit.class_at(declarator.start_byte)
            if declarator.type == "field_identifier" and name is not None and cls is not None:
                yield from self._member(cls, syntax.text(name), where, template)
            return
        given = declarator_arguments(unit, declarator)
        if given is not None and unit.function_at(declarator.start_byte) is not None:
            yield Site(where, tuple(Expr.of(unit, argument) for argument in given), template)

    def _member(self, cls: Class, name: str, where: Expr, template: tuple[Expr, ...]) -> Iterator[Site]:
        found = False
        for function in self._program.methods(cls):
            for entry in function.initialisers:
                if syntax.text(entry.named_children[0]) == name:
                    found = True
                    given = syntax.arguments(entry.named_children[-1])
                    arguments = tuple(Expr.of(function.unit, argument) for argument in given)
                    yield Site(where, arguments, template, place=Expr.of(function.unit, entry))
        default = cls.fields[name][1] if name in cls.fields else None
        if not found:
            given = syntax.arguments(default) if default is not None and default.type == "initializer_list" else []
            yield Site(where, tuple(Expr.of(cls.unit, argument) for argument in given), template)


def _declares(node: Node) -> bool:
    """Tell whether a name stands where its function is declared or defined."""
    inner = node
    for parent in syntax.outward(node, 4):
        if parent.type == "function_declarator":
            declarator = parent.child_by_field_name("declarator")
            return declarator is not None and declarator.id == inner.id
        if parent.type not in ("qualified_identifier", "template_function"):
            return False
        inner = parent
    return False


def fits(function: Function, count: int) -> bool:
    """Tell whether a function can be called with that many arguments."""
    parameters = function.parameters
    least = sum(1 for parameter in parameters if parameter.default is None)
    return least <= count + _defaults_elsewhere(function) and count <= len(parameters)


def accepts(function: Function, arguments: tuple[Expr, ...]) -> bool:
    """Tell whether literal arguments go with the types of a function's parameters, which tells overloads apart."""
    for parameter, argument in zip(function.parameters, arguments, strict=False):
        kind = syntax.simple_name(parameter.type) if parameter.type is not None else ""
        node = argument.node.type
        if node in _TEXTS and (kind in _NUMBERS or kind.endswith(("Ptr", "Interface"))):
            return False
        if kind == "string" and node in _NO_TEXTS:
            return False
    return True


def _defaults_elsewhere(function: Function) -> int:
    """Return how many defaults the declaration of a method may add to its definition."""
    return 0 if function.inside is not None or function.owner is None else len(function.parameters)


def _site(unit: Unit, call: Node, where: Node) -> Site:
    function = call.child_by_field_name("function")
    called = syntax.callee(function) if function is not None else None
    template = called.template if called is not None else None
    return Site(
        Expr.of(unit, where),
        tuple(Expr.of(unit, argument) for argument in syntax.arguments(call.child_by_field_name("arguments"))),
        tuple(Expr.of(unit, argument) for argument in syntax.arguments(template)),
    )


def _bound(unit: Unit, node: Node, *, method: bool) -> Site | None:
    """Return the site that `bind(&Class::method, object, ...)` stands for."""
    inner = node
    for parent in syntax.outward(node, 6):
        if parent.type == "argument_list":
            call = parent.parent
            function = call.child_by_field_name("function") if call is not None else None
            called = syntax.callee(function) if function is not None else None
            if call is None or called is None or called.name not in _BINDERS:
                return None
            given = syntax.arguments(parent)
            if given and given[0].id == inner.id:
                return Site(Expr.of(unit, call), tuple(Expr.of(unit, a) for a in given[2 if method else 1 :]))
            return None
        if parent.type not in ("pointer_expression", *_NAMING):
            return None
        inner = parent
    return None


def _bare(kind: Node) -> Node:
    """Return the type in a type descriptor."""
    inner = kind.child_by_field_name("type") if kind.type == "type_descriptor" else None
    return inner if inner is not None else kind


def _factory(unit: Unit, parent: Node, inner: Node, template: tuple[Expr, ...]) -> Iterator[Site]:
    """Yield the site of `Class<...>::create...(...)`, a static method that makes an object from its arguments."""
    method = parent.child_by_field_name("name")
    if method is None or not syntax.text(method).startswith("create"):
        return
    function = parent
    for outer in syntax.outward(parent, 6):
        if outer.type == "call_expression":
            given = syntax.arguments(outer.child_by_field_name("arguments"))
            yield Site(Expr.of(unit, inner), tuple(Expr.of(unit, argument) for argument in given), template)
            return
        if outer.type != "qualified_identifier" or _is_argument(outer, function):
            return
        function = outer


def _made(unit: Unit, parent: Node, inner: Node, template: tuple[Expr, ...]) -> Iterator[Site]:
    """Yield the site of `make_shared<Class>(...)`."""
    first = next(iter(syntax.arguments(parent)), None)
    if first is None or first.id != inner.id or parent.parent is None:
        return
    function = parent.parent
    for outer in syntax.outward(function, 3):
        if outer.type == "call_expression":
            called = syntax.callee(function)
            if called is not None and called.name in MAKERS:
                given = syntax.arguments(outer.child_by_field_name("arguments"))
                yield Site(Expr.of(unit, inner), tuple(Expr.of(unit, argument) for argument in given), template)
            return
        function = outer
