"""Types: what a type expression means after aliases and template parameters, and the type of an expression.

A type is known by its name only; `TypeName` keeps the parts of the name, its template arguments and the
place from which these are to be looked up. Pointers, references and `const` are peeled off.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

from kg.extract.cpp import syntax
from kg.extract.cpp.context import EMPTY, Site
from kg.extract.cpp.sites import MAKERS
from kg.extract.cpp.unit import Class, Expr
from kg.extract.cpp.variables import WriteKind, writes

if TYPE_CHECKING:
    from tree_sitter import Node

    from kg.extract.cpp.context import Context
    from kg.extract.cpp.program import Program
    from kg.extract.cpp.sites import Sites
    from kg.extract.cpp.unit import Function, Unit

__all__ = ["TypeName", "Types"]

POINTERS: Final = frozenset(
    [
        "Ptr",
        "ConstPtr",
        "SharedPtr",
        "ConstSharedPtr",
        "UniquePtr",
        "ConstUniquePtr",
        "WeakPtr",
        "ConstWeakPtr",
        "element_type",
        "Impl",
        "SharedConstPtr",
        "shared_ptr_type",
    ]
)
WRAPPERS: Final = frozenset(
    [
        "shared_ptr",
        "unique_ptr",
        "weak_ptr",
        "scoped_ptr",
        "intrusive_ptr",
        "optional",
        "MessageEvent",
        "ServiceEvent",
        "reference_wrapper",
        "atomic",
        "remove_reference_t",
        "decay_t",
        "remove_cv_t",
        "remove_const_t",
        "LoanedMessage",
    ]
)
_SECTIONS: Final = frozenset({"msg", "srv", "action"})
_PARTS_OF_INTERFACE: Final = frozenset({"Request", "Response", "Goal", "Result", "Feedback"})
_STANDARD: Final = frozenset(
    {"std", "boost", "Eigen", "cv", "pcl", "rclcpp", "ros", "rclcpp_action", "rclcpp_lifecycle"}
)
_AS_MESSAGE: Final = {
    "pcl::PointCloud": "sensor_msgs/PointCloud2",
    "pcl::PCLPointCloud2": "sensor_msgs/PointCloud2",
    "PointCloud": None,
}
_ANY_MESSAGE: Final = frozenset({("topic_tools", "ShapeShifter")})
"""Classes that take messages of whatever type."""
_DEEPEST: Final = 16


@dataclass(frozen=True, slots=True)
class TypeName:
    """A type: `parts` of its qualified name, template `arguments` of the last part, and where it stands."""

    parts: tuple[str, ...]
    arguments: tuple[Expr, ...]
    where: Expr

    @property
    def name(self) -> str:
        """The last part."""
        return self.parts[-1]

    @property
    def qualified(self) -> str:
        """The whole name."""
        return "::".join(self.parts)


class Types:
    """Looks types up in a program."""

    def __init__(self, program: Program, sites: Sites) -> None:
        self._program = program
        self._sites = sites
        self._aliases: dict[tuple[Unit, str], list[tuple[Unit, Node]]] = {}

    def settle(self, where: Expr, context: Context, depth: int = 0) -> list[tuple[TypeName, Context]]:
        """Return what a type expression can mean, with the choices of template arguments behind it."""
        if depth > _DEEPEST:
            return []
        node = where.node
        if node.type == "dependent_type" and node.named_children:
            return self.settle(where.child(node.named_children[0]), context, depth + 1)
        if node.type == "decltype":
            inner = next(iter(node.named_children), None)
            found = self.of(where.child(inner), context, depth + 1) if inner is not None else None
            return [(found, context)] if found is not None else []
        if node.type == "type_descriptor":
            inner = node.child_by_field_name("type")
            return self.settle(where.child(inner), context, depth + 1) if inner is not None else []
        parts = syntax.parts(node)
        while len(parts) > 1 and parts[-1].name in POINTERS:
            parts.pop()
        last = parts[-1]
        given = [where.child(argument) for argument in syntax.arguments(last.template)]
        if last.name in WRAPPERS and given:
            return self.settle(given[0], context, depth + 1)
        names = tuple(part.name.lstrip(":") for part in parts if part.name)
        if len(parts) == 2:  # noqa: PLR2004 - a member of a template parameter
            known = self._member_type(names, where, context, depth)
            if known is not None:
                return known
        known = self._behind(names, where, context, depth)
        if known is not None:
            return known
        return [(TypeName(names or ("",), tuple(given), where), context)]

    def _member_type(
        self, names: tuple[str, ...], where: Expr, context: Context, depth: int
    ) -> list[tuple[TypeName, Context]] | None:
        """Return what `T::name` means for a template parameter `T`; None where the first name is none."""
        bound = self._template(names[0], where, context)
        found: list[tuple[TypeName, Context]] = []
        for given, chosen in bound or ():
            for kind, after in self.settle(given, chosen, depth + 1):
                alias = self.alias(names[-1], kind.where.unit, kind.where.at, (kind.name,))
                found += self.settle(alias, after, depth + 1) if alias is not None else [(kind, after)]
        return found if bound is not None else None

    def _behind(
        self, names: tuple[str, ...], where: Expr, context: Context, depth: int
    ) -> list[tuple[TypeName, Context]] | None:
        """Return what stands behind a template parameter or an alias; None if the name is neither."""
        if len(names) == 1:
            bound = self._template(names[0], where, context)
            if bound is not None:
                found = [pair for given, chosen in bound for pair in self.settle(given, chosen, depth + 1)]
                return found or [(TypeName(names, (), where), context)]
        if names and names[0] not in _STANDARD:
            alias = self.alias(names[-1], where.unit, where.at, names[:-1])
            if alias is not None and alias.node.id != where.node.id:
                return self.settle(alias, context, depth + 1)
        return None

    def alias(self, name: str, unit: Unit, at: int, scope: tuple[str, ...] = ()) -> Expr | None:
        """Return the type behind `scope::name` if that is an alias seen from a byte of a unit."""
        key = (unit, name)
        if key not in self._aliases:
            own = [(unit, node) for node in unit.aliases.get(name, ())]
            others = [
                (u, node) for u in self._program.project.find(unit.file, name) for node in u.aliases.get(name, ())
            ]
            self._aliases[key] = own + others
        found = [pair for pair in self._aliases[key] if self._sees(pair, unit, at, scope)]
        best = max(
            found, key=lambda pair: (pair[0] is unit, pair[1].start_byte if pair[0] is unit else 0), default=None
        )
        return Expr.of(*best) if best is not None else None

    def _sees(self, alias: tuple[Unit, Node], unit: Unit, at: int, scope: tuple[str, ...]) -> bool:
        other, node = alias
        if node.start_byte <= at < node.end_byte and other is unit:
            return False
        function = other.function_at(node.start_byte)
        if function is not None and not (other is unit and function.start <= at < function.end):
            return False
        cls = other.class_at(node.start_byte)
        names = (*other.scope_at(node.start_byte), cls.name) if cls is not None else other.scope_at(node.start_byte)
        if scope:
            return names[-len(scope) :] == scope or (names[-1:] == scope[-1:] and cls is not None)
        if cls is None:
            return True
        around = self.class_around(unit, at)
        return around is not None and any(base is cls for base in self._program.family(around))

    def class_around(self, unit: Unit, at: int) -> Class | None:
        """Return the class whose members are in scope at a byte."""
        function = unit.function_at(at)
        if function is not None:
            return self._program.owner(function)
        return unit.class_at(at)

    def parameter(self, name: str, where: Expr, context: Context) -> list[tuple[Expr, Context]]:
        """Return the types that a template parameter seen from a place is bound to; none if `name` is not one."""
        return self._template(name, where, context) or []

    def _template(self, name: str, where: Expr, context: Context) -> list[tuple[Expr, Context]] | None:
        """Return what a template parameter is bound to; None if `name` is no template parameter there."""
        function = where.unit.function_at(where.at)
        if function is not None:
            index, default = _template_index(function.node, name)
            owner = self._program.owner(function) if function.inside is None else None
            if index >= 0 and owner is not None and _is_template(owner.node):
                return self._from_sites(owner, index, default, where, context, self._instantiations(owner))
            if index >= 0:
                found = self._from_sites(function, index, default, where, context, self._sites.calls(function))
                return found or self._deduced(function, name, context)
        cls = self.class_around(where.unit, where.at)
        if cls is None:
            return None
        index, default = _template_index(cls.node, name)
        if index < 0:
            return None
        return self._from_sites(cls, index, default, where, context, self._instantiations(cls))

    def _from_sites(  # noqa: PLR0913, PLR0917 - one call of one caller, kept apart for its length
        self, key: object, index: int, default: Node | None, where: Expr, context: Context, sites: list[Site]
    ) -> list[tuple[Expr, Context]]:
        choice = ("template", key)
        bound = context.get(choice) or context.get(key) or self._constructed_as(key, context)
        if isinstance(bound, Site) and index < len(bound.template):
            return [(bound.template[index], context)]
        found: dict[tuple[str, ...], tuple[Expr, Context]] = {}
        for site in sites:
            if index < len(site.template):
                shown = tuple(syntax.text(argument.node) for argument in site.template)
                found.setdefault(shown, (site.template[index], context.bind(choice, site)))
        if not found and default is not None:
            return [(where.child(default), context)]
        return list(found.values())

    def _deduced(self, function: Function, name: str, context: Context) -> list[tuple[Expr, Context]]:
        """Return what the template parameter of a function is by the arguments of its calls: `T` of `list<T>&`."""
        chosen = context.get(function)
        found = []
        for site in [chosen] if isinstance(chosen, Site) else self._sites.calls(function):
            for parameter, argument in zip(function.parameters, site.arguments, strict=False):
                given = syntax.template_arguments(parameter.type) if parameter.type is not None else []
                names = [syntax.simple_name(one) for one in given]
                kind = self.of(argument, context) if name in names else None
                if kind is not None and len(kind.arguments) > names.index(name):
                    found.append((kind.arguments[names.index(name)], context.bind(function, site)))
                    break
        return found

    def _constructed_as(self, key: object, context: Context) -> object | None:
        """Return the construction that a choice made before says an object of the class `key` comes from."""
        for function in self._program.methods(key) if isinstance(key, Class) else ():
            site = context.get(function) if function.name == function.owner else None
            if isinstance(site, Site) and site.template:
                return site
        return None

    def _instantiations(self, cls: Class) -> list[Site]:
        found = []
        for unit, node in self._program.sites(cls.name):
            parent = node.parent
            if parent is not None and parent.type in ("template_type", "template_method", "template_function"):
                if any(outer.type == "template_instantiation" for outer in syntax.outward(parent, 3)):
                    continue
                given = syntax.arguments(parent.child_by_field_name("arguments"))
                around = self.class_around(unit, node.start_byte)
                if given and around is not cls:
                    found.append(Site(Expr.of(unit, node), (), tuple(Expr.of(unit, argument) for argument in given)))
        return found

    def constructed(self, site: Site) -> list[TypeName]:
        """Return the types of the object that a construction site makes."""
        return [kind for kind, _ in self.settle(site.where, EMPTY)]

    def message(self, where: Expr, context: Context) -> list[tuple[str | None, Context]]:
        """Return the interface types (`package/Type`) that a type expression can mean; None where it is none."""
        return [(self.as_message(kind), chosen) for kind, chosen in self.settle(where, context)] or [(None, context)]

    def as_message(self, kind: TypeName) -> str | None:
        """Return the interface type that a C++ type stands for."""
        names = [name for name in kind.parts if name]
        while len(names) > 1 and names[-1] in _PARTS_OF_INTERFACE:
            names.pop()
        if len(names) > 1:
            names[:1] = kind.where.unit.namespace_aliases.get(names[0], names[0]).split("::")
        if kind.name == "TypeAdapter" and len(kind.arguments) > 1:
            return self.message(kind.arguments[1], EMPTY)[0][0]
        if tuple(names[-2:]) in _ANY_MESSAGE:
            return None
        known = _AS_MESSAGE.get("::".join(names[-2:]))
        if known is not None:
            return known
        if not names or not names[-1][:1].isalpha() or names[0] in ("std", "boost"):
            return None
        name = names[-1]
        sections = [i for i, part in enumerate(names[:-1]) if part in _SECTIONS]
        package = names[sections[-1] - 1] if sections and sections[-1] else names[-2] if len(names) > 1 else None
        if package is not None and package not in _SECTIONS and not self._is_class(name, package, kind.where.unit):
            return f"{package}/{_without_pointer(name)}"
        return self._by_include(_without_pointer(name), kind.where.unit)

    def _is_class(self, name: str, namespace: str, unit: Unit) -> bool:
        """Tell whether a qualified name is a class of the build rather than one generated from an interface."""
        found = self._program.find_class(name, unit, (namespace,))
        return found is not None and found.scope[-1:] == (namespace,)

    def _by_include(self, name: str, unit: Unit) -> str | None:
        """Return the interface type of an unqualified name by the generated header that the unit includes."""
        snake = _snake(name)
        files = [
            unit,
            *(u for u in (self._program.units.get(f) for f in self._program.project.headers(unit.file)) if u),
        ]
        for other in files:
            for path in other.includes:
                pieces = path.split("/")
                stem = pieces[-1].rpartition(".")[0]
                if len(pieces) == 2 and stem == name and not self._is_code(path, other):  # noqa: PLR2004 - package/Type.h
                    return f"{pieces[0]}/{name}"
                if len(pieces) == 3 and pieces[1] in _SECTIONS and stem == snake:  # noqa: PLR2004 - package/msg/type.hpp
                    return f"{pieces[0]}/{name}"
        return None

    def _is_code(self, path: str, unit: Unit) -> bool:
        return self._program.project.reader.workspace.include(path, near=unit.file) is not None

    def of(self, where: Expr, context: Context, depth: int = 0) -> TypeName | None:
        """Return the type of an expression, None where it cannot be told."""
        if depth > _DEEPEST:
            return None
        node = syntax.unwrap(where.node)
        where = where.child(node)
        if node.type == "this":
            cls = self.class_around(where.unit, where.at)
            return TypeName((*cls.scope, cls.name), (), Expr.of(cls.unit, cls.node)) if cls is not None else None
        if node.type in ("identifier", "field_identifier"):
            return self._of_name(syntax.text(node), where, context, depth)
        if node.type == "field_expression":
            return self._of_field(where, context, depth)
        if node.type == "call_expression":
            return self._of_call(where, context, depth)
        if node.type in ("new_expression", "compound_literal_expression"):
            kind = node.child_by_field_name("type")
            return self._first(where.child(kind), context, depth) if kind is not None else None
        if node.type == "subscript_expression":
            inner = node.child_by_field_name("argument")
            outer = self.of(where.child(inner), context, depth + 1) if inner is not None else None
            return self.element(outer, context, depth)
        return None

    def element(self, outer: TypeName | None, context: Context, depth: int = 0) -> TypeName | None:
        """Return the type of the elements of a container, of its values for a map."""
        if outer is None or not outer.arguments:
            return outer
        index = 1 if outer.name in ("map", "unordered_map") and len(outer.arguments) > 1 else 0
        return self._first(outer.arguments[index], context, depth)

    def _first(self, kind: Expr, context: Context, depth: int) -> TypeName | None:
        settled = self.settle(kind, context, depth + 1)
        return settled[0][0] if settled else None

    def _of_name(self, name: str, where: Expr, context: Context, depth: int) -> TypeName | None:
        declared = self.declaration(name, where)
        if declared is None:
            return None
        kind, value, element = declared
        if kind.node.type == "placeholder_type_specifier":
            found = self.of(value, context, depth + 1) if value is not None else None
            return self.element(found, context, depth) if element else found
        return self._first(kind, context, depth)

    def declaration(self, name: str, where: Expr) -> tuple[Expr, Expr | None, bool] | None:
        """Return the declared type of a name, its first value, and whether it is an element of that value."""
        unit = where.unit
        function = unit.function_at(where.at)
        if function is not None:
            local = [w for w in writes(unit, name, function.start, function.end) if w.type is not None]
            seen = [w for w in local if w.name.start_byte <= where.at and w.within[1] > where.at]
            for write in reversed(seen or local):
                if write.type is not None:
                    return Expr.of(unit, write.type), write.value, write.kind is WriteKind.ELEMENT
        around = self.class_around(unit, where.at)
        for cls in self._program.family(around) if around is not None else ():
            if name in cls.fields:
                kind, default, _ = cls.fields[name]
                return Expr.of(cls.unit, kind), Expr.of(cls.unit, default) if default is not None else None, False
        for write in writes(unit, name, 0, len(unit.source)):
            if write.type is not None and unit.function_at(write.name.start_byte) is None:
                return Expr.of(unit, write.type), write.value, False
        return None

    def is_handle(self, node: Node | None, unit: Unit) -> bool:
        """Tell whether a type node names a node handle of ROS 1."""
        settled = self.settle(Expr.of(unit, node), EMPTY) if node is not None else []
        return any(kind.name == "NodeHandle" for kind, _ in settled)

    def class_of(self, kind: TypeName | None) -> Class | None:
        """Return the class of the build that a type names."""
        if kind is None:
            return None
        return self._program.find_class(kind.name, kind.where.unit, kind.parts[:-1])

    def _of_field(self, where: Expr, context: Context, depth: int) -> TypeName | None:
        holder, field = where.node.child_by_field_name("argument"), where.node.child_by_field_name("field")
        if holder is None or field is None:
            return None
        if holder.type == "this":
            return self._of_name(syntax.simple_name(field), where, context, depth)
        cls = self.class_of(self.of(where.child(holder), context, depth + 1))
        for base in self._program.family(cls) if cls is not None else ():
            known = base.fields.get(syntax.simple_name(field))
            if known is not None:
                return self._first(Expr.of(base.unit, known[0]), context, depth)
        return None

    def _of_call(self, where: Expr, context: Context, depth: int) -> TypeName | None:
        function = where.node.child_by_field_name("function")
        called = syntax.callee(function) if function is not None else None
        if called is None or function is None:
            return None
        if called.name in MAKERS and called.template is not None:
            made = syntax.arguments(called.template)
            return self._first(where.child(made[0]), context, depth) if made else None
        if called.name in ("get", "lock", "value", "move", "ref", "cref", "at", "front", "back", "shared_from_this"):
            inner = called.receiver or next(iter(syntax.arguments(where.node.child_by_field_name("arguments"))), None)
            found = self.of(where.child(inner), context, depth + 1) if inner is not None else None
            return self.element(found, context, depth) if called.name in ("at", "front", "back") else found
        if called.name in ("getNodeHandle", "getPrivateNodeHandle", "getMTNodeHandle", "getMTPrivateNodeHandle"):
            return TypeName(("ros", "NodeHandle"), (), where)
        if called.receiver is None and called.name[:1].isupper():
            given = tuple(where.child(argument) for argument in syntax.arguments(called.template))
            return TypeName((*called.scope, called.name), given, where)
        for other in self._program.functions(called.name):
            kind = other.node.child_by_field_name("type")
            if kind is not None:
                return self._first(Expr.of(other.unit, kind), context, depth)
        return None


def _template_index(node: Node, name: str) -> tuple[int, Node | None]:
    """Return the place of a template parameter of a function or class, and its default; -1 if it has none so named."""
    outer = node.parent
    if outer is None or outer.type != "template_declaration":
        return -1, None
    listed = outer.child_by_field_name("parameters")
    for index, parameter in enumerate(syntax.arguments(listed)):
        words = [child for child in parameter.named_children if child.type in ("type_identifier", "identifier")]
        named = parameter.child_by_field_name("name") or (words[0] if words else None)
        if named is not None and syntax.text(named) == name:
            return index, parameter.child_by_field_name("default_type")
    return -1, None


def _is_template(node: Node) -> bool:
    return node.parent is not None and node.parent.type == "template_declaration"


def _without_pointer(name: str) -> str:
    for suffix in ("ConstPtr", "Ptr"):
        if name.endswith(suffix) and len(name) > len(suffix):
            return name.removesuffix(suffix)
    return name


def _snake(name: str) -> str:
    """Return the name of the generated header of a ROS 2 interface."""
    pieces: list[str] = []
    for index, letter in enumerate(name):
        after_small = index and (name[index - 1].islower() or name[index - 1].isdigit())
        before_small = index + 1 < len(name) and name[index + 1].islower()
        if letter.isupper() and index and (after_small or before_small):
            pieces.append("_")
        pieces.append(letter.lower())
    return "".join(pieces)
