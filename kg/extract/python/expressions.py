"""Python to the intermediate form: expressions.

Nodes are those of tree-sitter's grammar (github.com/tree-sitter/tree-sitter-python), which covers Python 2 as well.
Lowering reads one file; the language resolves names when the form runs. A comprehension becomes the call of a function
that fills a list or a dictionary, and an f-string a call of `str.format`.
"""

from __future__ import annotations

import ast
import math
import warnings
from typing import TYPE_CHECKING, ClassVar, Final

from kg.extract.python.syntax import argument_nodes, code, line_of, operands_of, parse, strip_parentheses
from kg.symbolic.form import (
    Assign,
    Binary,
    Block,
    Call,
    Choice,
    Declare,
    Display,
    Expression,
    Function,
    Index,
    Lambda,
    Literal,
    Loop,
    Member,
    Name,
    Opaque,
    Pairs,
    Parameter,
    Return,
    Spread,
    Statement,
    Step,
    Unary,
    Unit,
)
from kg.symbolic.form import Branch as If

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

    from tree_sitter import Node


YIELDED: Final = "<yielded>"
"""The variable that holds what a generator yields."""
_DEEPEST: Final = 120
_SHOWN: Final = 60
_SIGNS: Final = {"is": "==", "is not": "!=", "<>": "!="}
_TRUE_DIVISION: Final = "true/"
_LISTS: Final = ("pattern_list", "tuple_pattern", "list_pattern", "tuple", "list", "expression_list")
_ITEM: Final = "<item>"
_RESULT: Final = "<result>"
_ABSENT_SLICE: Final = 3


def expression_of(text: str) -> Expression:
    """Return the form of one Python expression; `Opaque` for text that is none."""
    root = parse(text.encode("utf-8", "replace")).root_node
    statement = root.named_children[0] if root.named_child_count == 1 and not root.has_error else None
    if statement is None or statement.type != "expression_statement" or statement.named_child_count != 1:
        return Opaque(1, text[:_SHOWN])
    return Expressions(Unit()).expression(statement.named_children[0])


class Expressions:
    """The expressions of one file. `sources` are their nodes, and the targets of loops, if it is asked for."""

    def __init__(self, unit: Unit, sources: dict[object, Node] | None = None) -> None:
        self._unit = unit
        self._depth = 0
        self.sources = sources

    def expression(self, node: Node | None) -> Expression:
        """Return the form of an expression; `Opaque` for no node, for too deep code and for what is not understood."""
        if node is None:
            return Opaque(0, "")
        node = strip_parentheses(node)
        self._depth += 1
        try:
            lower = self._lowered.get(node.type)
            if lower is None or self._depth > _DEEPEST:
                return Opaque(line_of(node), code(node)[:_SHOWN])
            lowered = lower(self, node)
            if self.sources is not None:
                self.sources[lowered] = node
            return lowered
        finally:
            self._depth -= 1

    def _all(self, nodes: list[Node]) -> tuple[Expression, ...]:
        return tuple(self.expression(node) for node in nodes if node.type != "comment")

    # Names and literals

    def _number(self, node: Node) -> Expression:
        written = code(node)
        plain = written.rstrip("lL").replace("_", "")
        octal = len(plain) > 1 and plain.isdigit() and plain.startswith("0")
        try:
            value = float(int(plain, 8 if octal else 0)) if node.type == "integer" else float(plain)
        except (ValueError, OverflowError):
            value = math.inf
        if not math.isfinite(value):
            return Opaque(line_of(node), written[:_SHOWN])
        return Literal(line_of(node), value, written.replace("_", "") if not octal else str(int(value)))

    def _string(self, node: Node) -> Expression:
        """Return a literal, or the formatting of a text with replacement fields, which adjacent strings share."""
        pieces = node.named_children if node.type == "concatenated_string" else [node]
        template, fields = "", []
        for piece in pieces:
            if piece.type != "string":
                continue
            for text, field in self._parts(piece):
                template += text.replace("{", "{{").replace("}", "}}")
                if field is not None:
                    value, format_of = field
                    template += "{" + format_of + "}"
                    fields.append(value)
        line = line_of(node)
        if not fields:
            return Literal(line, template.replace("{{", "{").replace("}}", "}"))
        return Call(line, Member(line, Literal(line, template), "format"), tuple(fields))

    def _parts(self, node: Node) -> Iterator[tuple[str, tuple[Expression, str] | None]]:
        """Yield the texts of a string, each with the replacement field behind it: value and format."""
        start, end = node.named_children[0], node.named_children[-1]
        prefix = code(start)
        raw = node.text or b""
        position, last = len(start.text or b""), len(raw) - (len(end.text or b"") if end.type == "string_end" else 0)
        formatted = "f" in prefix.rstrip("'\"").lower()

        def text(until: int) -> str:
            written = _decoded(prefix, raw[position:until].decode("utf-8", "replace"))
            return written.replace("{{", "{").replace("}}", "}") if formatted else written

        for child in node.named_children if formatted else ():
            if child.type == "interpolation":
                begin = child.start_byte - node.start_byte
                yield text(begin), self._field(child)
                position = child.end_byte - node.start_byte
        yield text(last), None

    def _field(self, node: Node) -> tuple[Expression, str]:
        parts = {child.type: child for child in node.named_children}
        value = self.expression(_first(node))
        specification = parts.get("format_specifier")
        if specification is not None and specification.named_child_count:
            return Opaque(line_of(node), code(node)[:_SHOWN], (value,)), ""
        return value, code(parts.get("type_conversion")) + code(specification)

    # Operators

    def _binary(self, node: Node) -> Expression:
        """Return a chain of one operator with all of its operands."""
        sign = code(node.child_by_field_name("operator"))
        operands = self._all(operands_of(node, sign))
        return Binary(line_of(node), _TRUE_DIVISION if sign == "/" else sign, operands)

    def _unary(self, node: Node) -> Expression:
        sign, operand = code(node.child_by_field_name("operator")), node.child_by_field_name("argument")
        inner = self.expression(operand)
        if sign == "-" and isinstance(inner, Literal) and isinstance(inner.value, float):
            minus, rest = ("", inner.written[1:]) if inner.written.startswith("-") else ("-", inner.written)
            return Literal(line_of(node), -inner.value, f"{minus}{rest}")
        return Unary(line_of(node), sign, inner)

    def _comparison(self, node: Node) -> Expression:
        line, operands = line_of(node), self._all(node.named_children)
        signs = [" ".join(code(one).split()) for one in node.children_by_field_name("operators")]
        pairs: list[Expression] = []
        for sign, left, right in zip(signs, operands, operands[1:], strict=False):
            compared = Binary(line, _SIGNS.get(sign, sign.removeprefix("not ")), (left, right))
            pairs.append(Unary(line, "not", compared) if sign == "not in" else compared)
        return pairs[0] if len(pairs) == 1 else Binary(line, "and", tuple(pairs))

    def _conditional(self, node: Node) -> Expression:
        then, condition, otherwise = (*self._all(node.named_children), *[Opaque(line_of(node), "")] * 3)[:3]
        return Choice(line_of(node), condition, then, otherwise)

    # Members, elements and calls

    def _attribute(self, node: Node) -> Expression:
        name = code(node.child_by_field_name("attribute"))
        return Member(line_of(node), self.expression(node.child_by_field_name("object")), name)

    def _subscript(self, node: Node) -> Expression:
        line, of = line_of(node), self.expression(node.child_by_field_name("value"))
        keys = node.children_by_field_name("subscript")
        if len(keys) == 1 and keys[0].type == "slice":
            return Call(line, Member(line, of, "<slice>"), self._bounds(keys[0]))
        key = self.expression(keys[0]) if len(keys) == 1 else Display(line, self._all(keys))
        return Index(line, of, key)

    def _bounds(self, node: Node) -> tuple[Expression, ...]:
        """Return start, stop and step of a slice; null for what is not given."""
        bounds: list[Expression] = [Literal(line_of(node), None)] * _ABSENT_SLICE
        index = 0
        for child in node.children:
            if child.type == ":":
                index += 1
            elif child.is_named and index < len(bounds):
                bounds[index] = self.expression(child)
        return tuple(bounds)

    def _call(self, node: Node) -> Expression:
        given: list[Expression] = []
        named: list[tuple[str, Expression]] = []
        for argument in argument_nodes(node):
            if argument.type == "keyword_argument":
                value = self.expression(argument.child_by_field_name("value"))
                named.append((code(argument.child_by_field_name("name")), value))
            elif argument.type == "dictionary_splat":
                named.append(("**", self.expression(argument.named_children[0])))
            else:
                given.append(self.expression(argument))
        function = self.expression(node.child_by_field_name("function"))
        return Call(line_of(node), function, tuple(given), tuple(named))

    def _splat(self, node: Node) -> Expression:
        return Spread(line_of(node), self.expression(_first(node)))

    # Collections

    def _display(self, node: Node) -> Expression:
        kind = node.type if node.type in ("list", "set") else "tuple"
        return Display(line_of(node), self._all(node.named_children), kind)

    def _dictionary(self, node: Node) -> Expression:
        line = line_of(node)
        parts: list[Expression] = []
        pairs: list[tuple[Expression, Expression]] = []
        for child in node.named_children:
            if child.type == "pair":
                pairs.append(self._pair(child))
            elif child.type == "dictionary_splat":
                parts += [Pairs(line, tuple(pairs)), self.expression(child.named_children[0])]
                pairs = []
        parts.append(Pairs(line, tuple(pairs)))
        return Binary(line, "|", tuple(parts)) if len(parts) > 1 else parts[0]

    def _pair(self, node: Node) -> tuple[Expression, Expression]:
        return self.expression(node.child_by_field_name("key")), self.expression(node.child_by_field_name("value"))

    def _comprehension(self, node: Node) -> Expression:
        line, body = line_of(node), node.child_by_field_name("body")
        result = Name(line, (_RESULT,))
        if node.type == "dictionary_comprehension" and body is not None:
            key, value = self._pair(body)
            start: Expression = Pairs(line, ())
            statement: Statement = Step(line, Assign(line, Index(line, result, key), value))
        else:
            start = Display(line, ())
            statement = Step(line, Assign(line, result, Display(line, (self.expression(body),)), "+"))
        for clause in reversed(node.named_children):
            if clause.type == "if_clause":
                condition = self.expression(_first(clause))
                statement = If(line, ((condition, Block(line, (statement,))),))
            elif clause.type == "for_in_clause":
                over = self.expression(clause.child_by_field_name("right"))
                statement = self.loop(line, clause.child_by_field_name("left"), over, (statement,))
        returned = Display(line, (Spread(line, result),), "set") if node.type == "set_comprehension" else result
        filled = (Declare(line, _RESULT, None, start), statement, Return(line, returned))
        return Call(line, Lambda(line, self._function(line, (), Block(line, filled))), ())

    def loop(self, line: int, target: Node | None, over: Expression, body: tuple[Statement, ...]) -> Loop:
        """Return a loop over a collection; targets that are not plain names are assigned in its body."""
        names = [target] if target is not None and target.type not in _LISTS else list(_children(target))
        if names and all(name.type == "identifier" for name in names):
            loop = Loop(line, Block(line, body, open=True), tuple(code(name) for name in names), over)
        else:
            first = Step(line, Assign(line, self.expression(target), Name(line, (_ITEM,))))
            loop = Loop(line, Block(line, (first, *body), open=True), (_ITEM,), over)
        if self.sources is not None and target is not None:
            self.sources[loop] = target
        return loop

    # Functions

    def _lambda(self, node: Node) -> Expression:
        line = line_of(node)
        body = Block(line, (Return(line, self.expression(node.child_by_field_name("body"))),))
        return Lambda(line, self._function(line, self.parameters(node), body))

    def _function(self, line: int, parameters: tuple[Parameter, ...], body: Block) -> Function:
        return Function(self._unit, "<lambda>", (), parameters, line, lowered_body=body)

    def parameters(self, node: Node) -> tuple[Parameter, ...]:
        """Return the parameters of a function or lambda."""
        parameters: list[Parameter] = []
        named = False
        for child in _children(node.child_by_field_name("parameters")):
            inner = child.named_children[0] if child.type == "typed_parameter" else child
            if inner.type == "keyword_separator":
                named = True
            elif inner.type in ("list_splat_pattern", "dictionary_splat_pattern"):
                name = code(inner.named_children[0]) if inner.named_child_count else ""
                parameters.append(Parameter(name, None, variadic=True, named=inner.type == "dictionary_splat_pattern"))
                named = True
            elif inner.type != "positional_separator":
                default = child.child_by_field_name("value")
                value = self.expression(default) if default is not None else None
                name = code(inner.child_by_field_name("name") or inner)
                parameters.append(Parameter(name, None, value, named=named))
        return tuple(parameters)

    # Others

    def _walrus(self, node: Node) -> Expression:
        target = self.expression(node.child_by_field_name("name"))
        return Assign(line_of(node), target, self.expression(node.child_by_field_name("value")))

    def _yield(self, node: Node) -> Expression:
        """Return the addition of what a generator yields to the list of all that it yields."""
        line, given = line_of(node), _children(node)
        several = any(child.type == "from" for child in node.children)
        value = self.expression(given[0]) if given else Literal(line, None)
        return Call(line, Member(line, Name(line, (YIELDED,)), "extend" if several else "append"), (value,))

    _lowered: ClassVar[dict[str, Callable[[Expressions, Node], Expression]]] = {
        "identifier": lambda _, node: Name(line_of(node), (code(node),)),
        "true": lambda _, node: Literal(line_of(node), True),
        "false": lambda _, node: Literal(line_of(node), False),
        "none": lambda _, node: Literal(line_of(node), None),
        **dict.fromkeys(("integer", "float"), _number),
        **dict.fromkeys(("string", "concatenated_string"), _string),
        **dict.fromkeys(("binary_operator", "boolean_operator"), _binary),
        "unary_operator": _unary,
        "not_operator": lambda self, node: Unary(
            line_of(node), "not", self.expression(node.child_by_field_name("argument"))
        ),
        "comparison_operator": _comparison,
        "conditional_expression": _conditional,
        "attribute": _attribute,
        "subscript": _subscript,
        "call": _call,
        **dict.fromkeys(("list_splat", "list_splat_pattern"), _splat),
        **dict.fromkeys((*_LISTS, "set"), _display),
        "dictionary": _dictionary,
        **dict.fromkeys(
            ("list_comprehension", "generator_expression", "set_comprehension", "dictionary_comprehension"),
            _comprehension,
        ),
        "lambda": _lambda,
        "named_expression": _walrus,
        **dict.fromkeys(("await", "as_pattern_target"), lambda self, node: self.expression(_first(node))),
        **dict.fromkeys(
            ("exec_statement", "chevron"),
            lambda self, node: Opaque(line_of(node), code(node)[:_SHOWN], self._all(node.named_children)),
        ),
        "yield": _yield,
    }


def _children(node: Node | None) -> list[Node]:
    return [child for child in node.named_children if child.type != "comment"] if node is not None else []


def _first(node: Node) -> Node | None:
    return node.named_children[0] if node.named_child_count else None


def _decoded(prefix: str, body: str) -> str:
    """Return the text of a string literal; `prefix` is the letters and quotes that it begins with."""
    letters = prefix.rstrip("'\"").lower()
    if "r" in letters or "\\" not in body:
        return body
    quote = prefix[len(letters) :] or '"'
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            value = ast.literal_eval(f"{quote}{body}{quote}")
    except (SyntaxError, ValueError):
        return body
    return value if isinstance(value, str) else body
