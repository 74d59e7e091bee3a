"""C++ to the intermediate form: types and expressions.

Nodes are those of tree-sitter's grammar (github.com/tree-sitter/tree-sitter-cpp). Lowering reads one file; the language
resolves names when the form runs.
"""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, ClassVar, Final

from kg.extract.cpp import syntax
from kg.extract.cpp.syntax import line_of
from kg.symbolic.form import (
    Assign,
    Binary,
    Call,
    Choice,
    Construct,
    Display,
    Expression,
    Function,
    Index,
    Lambda,
    Literal,
    Member,
    Name,
    Opaque,
    Parameter,
    Spread,
    Type,
    Unary,
    Unit,
)

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable

    from tree_sitter import Node


_DEEPEST: Final = 150
_SHOWN: Final = 60
_NAMES: Final = frozenset(
    {"identifier", "field_identifier", "type_identifier", "namespace_identifier", "primitive_type", "operator_name"}
)
_BEGINS: Final = frozenset({"begin", "cbegin"})
"""Methods of containers whose result points to the first element: `*names.begin()`."""
_ENDS: Final = frozenset({"end", "cend"})
_STEPS: Final = {"+": _BEGINS, "-": _ENDS}
"""Operators that move from the first or behind the last element of a container: `names.begin() + 1`."""
_PAIR: Final = 2
_CASTS: Final = frozenset(
    {"static_cast", "dynamic_cast", "const_cast", "reinterpret_cast", "static_pointer_cast", "dynamic_pointer_cast"}
)
_DURATIONS: Final = frozenset({"h", "min", "s", "ms", "us", "ns"})
"""Suffixes of the durations of std::chrono."""
_TYPES: Final = frozenset(
    {
        "type_identifier", "primitive_type", "sized_type_specifier", "template_type", "qualified_identifier",
        "dependent_type", "type_descriptor", "placeholder_type_specifier", "struct_specifier", "class_specifier",
        "enum_specifier", "decltype",
    }
)  # fmt: skip
PREPROCESSED: Final = frozenset({"preproc_if", "preproc_ifdef", "preproc_else", "preproc_elif", "preproc_elifdef"})


def _without_suffix(written: str) -> str:
    """Return a number literal of C++ without separators and the suffix of its type."""
    plain = written.replace("'", "")
    return plain.rstrip("uUlLzZ" if plain.startswith(("0x", "0X")) else "fFlLuUzZ")


def plain_number(written: str) -> float | None:
    """Return the value of a number literal of C++; None where it is none."""
    plain = _without_suffix(written)
    hexadecimal = plain.startswith(("0x", "0X"))
    try:
        return float(int(plain, 0)) if hexadecimal or not any(c in plain for c in ".eE") else float(plain)
    except ValueError:
        try:
            return float(int(plain, 8))
        except ValueError:
            return None


class Expressions:
    """The types and expressions of one file."""

    def __init__(self, unit: Unit) -> None:
        self._unit = unit
        self._depth = 0

    # Types

    def type(
        self, node: Node | None, *, reference: bool = False, pointer: bool = False, constant: bool = False
    ) -> Type:
        """Return the type that a node writes."""
        if node is not None and node.type in syntax.PLAIN:
            shown = syntax.text(node)
            return Type((shown,) if shown else (), (), (), reference, pointer, constant)
        names: list[str] = []
        arguments: tuple[Type | Expression, ...] = ()
        outer: tuple[Type | Expression, ...] = ()
        for part in syntax.parts(node) if node is not None else ():
            if part.name:
                names.append(part.name)
            outer = outer or arguments
            arguments = self.template(part.template)
        if node is not None and node.type == "type_descriptor":
            declarator = node.child_by_field_name("declarator")
            kind = declarator.type if declarator is not None else ""
            if kind == "abstract_function_declarator":
                return self._function(declarator)
            reference, pointer = reference or "reference" in kind, pointer or "pointer" in kind
            constant = constant or any(child.type == "type_qualifier" for child in node.named_children)
        return Type(tuple(names), arguments, outer if arguments is not outer else (), reference, pointer, constant)

    def _function(self, declarator: Node | None) -> Type:
        """Return the type of a function, whose arguments are the types of its parameters."""
        return Type(("()",), tuple(p.type for p in self.parameters(declarator) if p.type is not None))

    def template(self, node: Node | None) -> tuple[Type | Expression, ...]:
        """Return the forms of a list of template arguments."""
        if node is None:
            return ()
        return tuple(
            self.type(child) if child.type in _TYPES else self.expression(child) for child in syntax.arguments(node)
        )

    def declared(self, node: Node, declarator: Node | None) -> Type:
        """Return the type of a declaration, including its declarator."""
        kind = node.child_by_field_name("type")
        reference = pointer = False
        while declarator is not None and declarator.type not in _NAMES:
            reference = reference or declarator.type in ("reference_declarator", "abstract_reference_declarator")
            pointer = pointer or declarator.type in ("pointer_declarator", "abstract_pointer_declarator")
            if declarator.type in ("function_declarator", "abstract_function_declarator"):
                if syntax.is_function_pointer(declarator):
                    return self._function(declarator)
                break
            inner = declarator.child_by_field_name("declarator")
            if inner is None and declarator.type in ("reference_declarator", "parenthesized_declarator"):
                inner = next(iter(declarator.named_children), None)
            declarator = inner
        constant = any(c.type == "type_qualifier" and syntax.text(c) == "const" for c in node.children)
        return self.type(kind, reference=reference, pointer=pointer, constant=constant)

    def parameters(self, declarator: Node | None) -> tuple[Parameter, ...]:
        """Return the parameters of a function or lambda declarator."""
        listed = declarator.child_by_field_name("parameters") if declarator is not None else None
        parameters: list[Parameter] = []
        for child in syntax.arguments(listed):
            if child.type in (
                "parameter_declaration",
                "optional_parameter_declaration",
                "variadic_parameter_declaration",
            ):
                inner = child.child_by_field_name("declarator")
                name = syntax.declared_name(inner)
                default = child.child_by_field_name("default_value")
                variadic = child.type == "variadic_parameter_declaration"
                shown = syntax.text(name).lstrip(".").strip() if name is not None else ""
                kind = self.declared(child, inner)
                initial = self.expression(default) if default is not None else None
                if isinstance(initial, Construct) and not initial.type.names:  # `Handle pnh = {"~"}`
                    initial = replace(initial, type=replace(kind, reference=False))
                parameters.append(Parameter(shown, kind, initial, variadic))
        return tuple(parameters)

    # Expressions

    def expression(self, node: Node) -> Expression:
        """Return the form of an expression."""
        self._depth += 1
        try:
            if self._depth > _DEEPEST:
                return self._opaque(node)
            lower = self._lowered.get(node.type)
            return lower(self, node) if lower is not None else self._opaque(node)
        finally:
            self._depth -= 1

    def expressions(self, nodes: Iterable[Node]) -> tuple[Expression, ...]:
        """Return the forms of some expressions."""
        return tuple(self.expression(node) for node in nodes)

    def _opaque(self, node: Node) -> Expression:
        shown = " ".join(syntax.text(node).split())
        parts = (
            ()
            if self._depth > _DEEPEST
            else tuple(self.expression(child) for child in node.named_children if child.type in self._lowered)
        )
        return Opaque(line_of(node), shown if len(shown) < _SHOWN else shown[: _SHOWN - 3] + "...", parts)

    def _plain(self, node: Node) -> Expression:
        shown = syntax.text(node)
        return Name(line_of(node), (shown,)) if shown else self._opaque(node)

    def _name(self, node: Node) -> Expression:
        parts = syntax.parts(node)
        written = next((part.template for part in reversed(parts) if part.template is not None), None)
        template = self.template(written)
        around = next((part.template for part in reversed(parts[:-1]) if part.template is not None), None)
        outer = template if around is written else self.template(around)
        names = tuple(part.name for part in parts if part.name)
        if len(names) == 1 and node.type == "qualified_identifier":
            names = ("", *names)  # `::name`
        return Name(line_of(node), names, template, outer) if names else self._opaque(node)

    def _number(self, node: Node) -> Expression:
        written = syntax.text(node)
        value = plain_number(written)
        if value is None:
            return Opaque(line_of(node), written)
        return Literal(line_of(node), value, _without_suffix(written))

    def _inner(self, node: Node) -> Expression:
        inner = next((child for child in node.named_children if child.type != "comment"), None)
        return self.expression(inner) if inner is not None else self._opaque(node)

    def _spread(self, node: Node) -> Expression:
        """Return an expansion of a pack, or a fold over one."""
        inner = self._inner(node)
        return inner if isinstance(inner, Name) else Spread(line_of(node), inner)

    def _user_defined(self, node: Node) -> Expression:
        """Return `100ms` as a call of its operator; a literal that is not a duration is its own value."""
        value, suffix = node.named_children[0], syntax.text(node.named_children[-1])
        if value.type != "number_literal" or suffix not in _DURATIONS:
            return self._inner(node)
        return Call(line_of(node), Name(line_of(node), ('operator""', suffix)), (self.expression(value),))

    def _cast(self, node: Node) -> Expression:
        value = node.child_by_field_name("value")
        if value is None:
            return self._opaque(node)
        return self._converted(node, node.child_by_field_name("type"), self.expression(value))

    def _call(self, node: Node) -> Expression:
        function = node.child_by_field_name("function")
        given = self.arguments(node.child_by_field_name("arguments"))
        if function is None:
            return self._opaque(node)
        if function.type in ("template_function", "qualified_identifier"):
            parts = syntax.parts(function)
            if given and parts and parts[-1].name in _CASTS:
                templates = (syntax.arguments(part.template) for part in parts)
                return self._converted(node, next((one for listed in templates for one in listed), None), given[0])
        if function.type in ("primitive_type", "sized_type_specifier"):
            return Construct(line_of(node), self.type(function), given)
        # In a chain of calls over several lines, a call is on the line of its name, not on that of the first one.
        named = function.child_by_field_name("field") if function.type == "field_expression" else None
        return Call(line_of(named or function), self.expression(function), given)

    def _converted(self, node: Node, to: Node | None, given: Expression) -> Expression:
        """Return the operand of a cast, or a number of a built-in type; other types keep their value."""
        kind = self.type(to.child_by_field_name("type") or to) if to is not None else None
        if kind is not None and kind.names in (("int",), ("float",), ("double",)):
            return Construct(line_of(node), kind, (given,))
        return given

    def arguments(self, node: Node | None) -> tuple[Expression, ...]:
        """Return the forms of an argument list; `"text" MACRO` is one argument."""
        arguments: list[Expression] = []
        for child in node.named_children if node is not None else ():
            if child.type == "comment" or child.type in PREPROCESSED:
                continue
            if child.type == "ERROR":
                if arguments and child.named_children:
                    joined = (arguments.pop(), *self.expressions(child.named_children))
                    arguments.append(Binary(line_of(child), "+", joined))
                continue
            arguments.append(self.expression(child))
        return tuple(arguments)

    def _field(self, node: Node) -> Expression:
        of, named = node.child_by_field_name("argument"), node.child_by_field_name("field")
        if of is None or named is None:
            return self._opaque(node)
        last = syntax.parts(named)[-1]
        return Member(line_of(named), self.expression(of), last.name, self.template(last.template))

    def _new(self, node: Node) -> Expression:
        kind = self.type(node.child_by_field_name("type"))
        given = node.child_by_field_name("arguments")
        if node.child_by_field_name("declarator") is not None:
            return Opaque(line_of(node), "new[]")
        return Construct(
            line_of(node),
            kind,
            self.arguments(given),
            heap=True,
            listed=given is not None and given.type == "initializer_list",
        )

    def _binary(self, node: Node) -> Expression:
        operator = node.child_by_field_name("operator")
        sign = syntax.text(operator) if operator is not None else ""
        operands: list[Node] = []
        current = node
        while current.type == "binary_expression":
            inner = current.child_by_field_name("operator")
            left, right = current.child_by_field_name("left"), current.child_by_field_name("right")
            if inner is None or left is None or right is None or syntax.text(inner) != sign:
                break
            operands.append(right)
            current = left
        operands.append(current)
        if sign == ">>":
            return Call(line_of(node), Name(line_of(node), ("operator>>",)), self.expressions(reversed(operands)))
        values = self.expressions(reversed(operands))
        of = values[0].function if isinstance(values[0], Call) and not values[0].arguments else None
        if len(values) == _PAIR and isinstance(of, Member) and of.name in _STEPS.get(sign, ()):
            return Call(line_of(node), of, values[1:])
        return Binary(line_of(node), sign, values)

    def _size(self, node: Node) -> Expression:
        pack = syntax.of_type(node, "identifier")
        if not pack or not any(child.type == "..." for child in node.children):
            return Opaque(line_of(node), "sizeof")
        name = Literal(line_of(node), syntax.text(pack[0]))
        return Call(line_of(node), Name(line_of(node), ("sizeof...",)), (name,))

    def _unary(self, node: Node) -> Expression:
        operator, operand = node.child_by_field_name("operator"), node.child_by_field_name("argument")
        if operator is None or operand is None:
            return self._opaque(node)
        value = self.expression(operand)
        if syntax.text(operator) == "*" and isinstance(value, Call) and isinstance(at := value.function, Member):
            moved = value if value.arguments and at.name in _BEGINS | _ENDS else None
            if moved is not None or (at.name in _BEGINS and not value.arguments):
                return Call(line_of(node), Member(at.line, moved or at.of, "front"), ())
        return Unary(line_of(node), syntax.text(operator), value)

    def _assignment(self, node: Node) -> Expression:
        left, right = node.child_by_field_name("left"), node.child_by_field_name("right")
        operator = node.child_by_field_name("operator")
        if left is None or right is None or operator is None:
            return self._opaque(node)
        target = self.expression(left)
        function = target.function if isinstance(target, Call) and len(target.arguments) == 1 else None
        if isinstance(target, Call) and isinstance(function, Member) and function.name == "at":
            target = Index(target.line, function.of, target.arguments[0])
        elif isinstance(target, Call) and isinstance(target.function, Name) and target.function.names[-1] == "tie":
            target = Display(target.line, target.arguments)
        return Assign(line_of(node), target, self.expression(right), syntax.text(operator)[:-1])

    def _conditional(self, node: Node) -> Expression:
        parts = [node.child_by_field_name(name) for name in ("condition", "consequence", "alternative")]
        if any(part is None for part in parts):
            return self._opaque(node)
        condition, then, otherwise = (self.expression(part) for part in parts if part is not None)
        return Choice(line_of(node), condition, then, otherwise)

    def _subscript(self, node: Node) -> Expression:
        of, indices = node.child_by_field_name("argument"), node.child_by_field_name("indices")
        given = syntax.arguments(indices)
        if of is None or len(given) != 1:
            return self._opaque(node)
        return Index(line_of(node), self.expression(of), self.expression(given[0]))

    def _pair(self, node: Node) -> Expression:
        value = node.child_by_field_name("value")
        designator = node.child_by_field_name("designator")
        if value is None or designator is None:
            return self._opaque(node)
        name = syntax.text(designator).lstrip(".")
        return Assign(line_of(node), Name(line_of(node), (name,)), self.expression(value), "designated")

    def _compound(self, node: Node) -> Expression:
        value = node.child_by_field_name("value") or node.child_by_field_name("arguments")
        kind = self.type(node.child_by_field_name("type"))
        return Construct(line_of(node), kind, self.arguments(value), listed=True)

    def _lambda(self, node: Node) -> Expression:
        body = node.child_by_field_name("body")
        function = Function(
            self._unit,
            "lambda",
            (),
            self.parameters(node.child_by_field_name("declarator")),
            line_of(node),
            source=body,
        )
        captured, shared = self._captures(node.child_by_field_name("captures"))
        return Lambda(line_of(node), function, captured, shared)

    def _captures(self, node: Node | None) -> tuple[tuple[tuple[str, Expression], ...], frozenset[str] | None]:
        """Return what a lambda copies or makes, and what it shares if it copies all else."""
        captured: list[tuple[str, Expression]] = []
        shared: set[str] = set()
        copies = False
        for child in node.named_children if node is not None else ():
            before = child.prev_sibling
            name = syntax.text(child)
            if child.type == "lambda_default_capture":
                copies = name == "="
            elif child.type == "lambda_capture_initializer" and len(child.named_children) > 1:
                value = self.expression(child.named_children[1])
                by_reference = child.children[0].type == "&"
                line = line_of(child)
                captured.append(
                    (syntax.text(child.named_children[0]), Unary(line, "&", value) if by_reference else value)
                )
            elif child.type == "identifier" and before is not None and before.type == "&":
                shared.add(name)
            elif child.type == "identifier":
                captured.append((name, self.expression(child)))
        return tuple(captured), frozenset(shared) if copies else None

    def _comma(self, node: Node) -> Expression:
        sides = [node.child_by_field_name(name) for name in ("left", "right")]
        return Binary(line_of(node), ",", self.expressions(side for side in sides if side is not None))

    def is_expression(self, node: Node) -> bool:
        """Return whether a node is an expression."""
        return node.type in self._lowered

    _lowered: ClassVar[dict[str, Callable[[Expressions, Node], Expression]]] = {
        "identifier": _plain,
        "field_identifier": _plain,
        "qualified_identifier": _name,
        "template_function": _name,
        "dependent_name": _name,
        "type_identifier": _plain,
        "this": lambda _, node: Name(line_of(node), ("this",)),
        **dict.fromkeys(
            ("string_literal", "raw_string_literal", "char_literal"),
            lambda _, node: Literal(line_of(node), syntax.literal(node)),
        ),
        "user_defined_literal": _user_defined,
        "concatenated_string": lambda self, node: Binary(line_of(node), "+", self.expressions(syntax.arguments(node))),
        "number_literal": _number,
        **dict.fromkeys(("true", "false"), lambda _, node: Literal(line_of(node), node.type == "true")),
        **dict.fromkeys(("null", "nullptr"), lambda _, node: Literal(line_of(node), None)),
        "parenthesized_expression": _inner,
        "condition_clause": _inner,
        **dict.fromkeys(("parameter_pack_expansion", "fold_expression"), _spread),
        "cast_expression": _cast,
        "call_expression": _call,
        "field_expression": _field,
        "new_expression": _new,
        "binary_expression": _binary,
        "unary_expression": _unary,
        "pointer_expression": _unary,
        "update_expression": _unary,
        "assignment_expression": _assignment,
        "conditional_expression": _conditional,
        "subscript_expression": _subscript,
        "initializer_list": lambda self, node: Display(line_of(node), self.arguments(node)),
        "initializer_pair": _pair,
        "compound_literal_expression": _compound,
        "lambda_expression": _lambda,
        "comma_expression": _comma,
        **dict.fromkeys(("template_type", "type_descriptor", "primitive_type"), lambda self, node: self.type(node)),
        "delete_expression": lambda _, node: Opaque(line_of(node), "delete"),
        "sizeof_expression": _size,
    }
