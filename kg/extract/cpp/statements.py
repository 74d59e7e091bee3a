"""C++ to the intermediate form: statements."""

from __future__ import annotations

import re
from dataclasses import replace
from typing import TYPE_CHECKING, ClassVar, Final

from tree_sitter import Node, Query

from kg.extract.cpp import syntax
from kg.extract.cpp.expressions import PREPROCESSED, Expressions
from kg.extract.cpp.syntax import line_of
from kg.extract.cpp.tokens import STREAMS
from kg.symbolic.form import (
    Assign,
    Binary,
    Block,
    Branch,
    Call,
    Case,
    Construct,
    Declare,
    Display,
    Expression,
    Index,
    Jump,
    Literal,
    Loop,
    Member,
    Name,
    Opaque,
    Return,
    Statement,
    Static,
    Step,
    Try,
    Type,
    Unary,
)

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Sequence


_DEEPEST: Final = 150
_MOST_STREAMS: Final = 64
_EXITS: Final = frozenset({("exit",), ("", "exit"), ("std", "exit"), ("_exit",)})
"""Functions that end the program, with its result as their argument."""
_SKIPPED: Final = frozenset({"comment", "ERROR"})
_SHELLS: Final = frozenset(
    {"translation_unit", "expression_statement", "parenthesized_expression", "comma_expression", "ERROR"}
)
_IDENTIFIERS: Final = Query(syntax.LANGUAGE, "(identifier) @name")
_STRUCTURED: Final = "structured_binding_declarator"
_ELEMENT: Final = Type(("auto",), reference=True)
"""The type of a name that means an element: an iterator the one that it is at, or a name of a structured binding."""
_TABLES: Final = frozenset({"poptOption", "option"})
"""The classes of tables of options of the command line, of popt and of getopt."""
_BODIES: Final = frozenset({"compound_statement", "translation_unit", "declaration_list"})
_BEGINNINGS: Final = frozenset({"begin", "cbegin", "rbegin", "crbegin", "lower_bound"})


class Statements:
    """The statements of one file."""

    def __init__(self, expressions: Expressions, source: bytes) -> None:
        self._expressions = expressions
        self._source = source
        self._depth = 0

    def block(self, node: Node | None) -> Block:
        """Return the form of a compound statement, or of one statement."""
        if node is None:
            return Block(0, ())
        children = node.named_children if node.type in _BODIES else [node]
        return Block(line_of(node), tuple(self._statements(children)))

    def statement(self, node: Node) -> list[Statement]:
        """Return the forms of one statement of the source, which may be several or none."""
        self._depth += 1
        try:
            if self._depth > _DEEPEST:
                return []
            lower = self._lowered.get(node.type)
            if lower is not None:
                return list(lower(self, node))
            if self._expressions.is_expression(node):
                return [Step(line_of(node), self._expressions.expression(node))]
            return []
        finally:
            self._depth -= 1

    def _declaration(self, node: Node) -> list[Statement]:
        """Return the variables that a declaration in a function declares."""
        static = any(c.type == "storage_class_specifier" and syntax.text(c) == "static" for c in node.children)
        declared = [self._static(one, node) if static else one for one in self.declaration(node)]
        return [*declared, *(_by_options(node) if any(_is_table(one) for one in declared) else ())]

    def _static(self, one: Declare, node: Node) -> Static:
        """Return a variable that keeps its value from call to call."""
        rest = node.parent
        switched = False
        if one.type is not None and one.type.names == ("bool",) and rest is not None:
            after = self._source[node.end_byte : rest.end_byte].decode(errors="replace")
            switched = re.search(rf"\b{re.escape(one.name)}\s*=(?!=)", after) is not None
        return Static(one.line, one.name, one.type, one.value, switched)

    def _expression_statement(self, node: Node) -> list[Statement]:
        inner = next((c for c in node.named_children if c.type not in _SKIPPED), None)
        if inner is None:
            return []
        step = Step(line_of(node), self._expressions.expression(inner))
        called = step.value.function if isinstance(step.value, Call) and step.value.arguments else None
        ends = isinstance(called, Name) and called.names in _EXITS
        return [step, Jump(step.line, "exit")] if ends else [step]

    def declaration(self, node: Node) -> list[Declare]:
        """Return the variables of a declaration."""
        declarations: list[Declare] = []
        for child in node.children_by_field_name("declarator"):
            declarations += self._declared(node, child)
        return declarations

    def _declared(self, node: Node, declarator: Node) -> list[Declare]:
        line = line_of(node)
        initialised = declarator.type == "init_declarator"
        target = declarator.child_by_field_name("declarator") if initialised else declarator
        if target is None:
            return []
        written = declarator.child_by_field_name("value") if initialised else None
        if _STRUCTURED in (target.type, *(child.type for child in target.named_children)):
            return self._structured(target, written, line)
        kind = self._expressions.declared(node, target)
        if written is not None and written.type == "pointer_expression" and syntax.text(written).startswith("&"):
            kind = replace(kind, pointer=True)  # `auto p = &object`
        if written is None and target.type == "function_declarator":
            return self._vexing(node, target, kind)
        name = syntax.declared_name(target)
        value = self.begin(written, target, kind, line_of(declarator)) if written is not None else None
        if value is None and kind.name in STREAMS and (count := _count(target)):
            value, kind = Display(line, (Construct(line, kind, ()),) * count), Type(("vector",), (kind,))
        if isinstance(value, Display) and any(isinstance(one, Construct) for one in value.items):
            kind = Type(("vector",), (kind,)) if _dimensions(target) else kind
        return [Declare(line, syntax.text(name), kind, value)] if name is not None else []

    def _structured(self, target: Node, written: Node | None, line: int) -> list[Declare]:
        """Return the object without a name that `auto [a, b] = value` declares, and the names of its elements."""
        kind = Type(("auto",), reference=target.type == "reference_declarator")
        whole = syntax.text(target)
        value = self.begin(written, target, kind, line) if written is not None else None
        return [
            Declare(line, whole, kind, value),
            *(
                Declare(line, name, _ELEMENT, Index(line, Name(line, (whole,)), Literal(line, float(i), str(i))))
                for i, name in enumerate(_names(target))
            ),
        ]

    def begin(self, written: Node, target: Node, kind: Type, line: int) -> Expression:
        """Return the first value of a variable: `= value`, `(value)` or `{value}`."""
        if written.type not in ("argument_list", "initializer_list"):
            return self._expressions.expression(written)
        given, listed = self._expressions.arguments(written), written.type == "initializer_list"
        if listed and (dimensions := _dimensions(target)):
            if dimensions == 1:  # an element in braces is an object
                given = tuple(
                    Construct(line, kind, one.items, listed=True) if isinstance(one, Display) else one for one in given
                )
            return Display(line, given)
        if kind.names != ("auto",):
            return Construct(line, kind, given, listed=listed)
        return given[0] if len(given) == 1 else Display(line, given)

    def _vexing(self, node: Node, declarator: Node, kind: Type) -> list[Declare]:
        """Return the variable that the grammar parsed as the declaration of a function: `Foo foo(bar);`."""
        name = syntax.declared_name(declarator)
        listed = declarator.child_by_field_name("parameters")
        if name is None or listed is None or name.type != "identifier" or not listed.named_children:
            return []  # `Foo foo();` declares a function
        declarators = [c.child_by_field_name("declarator") for c in syntax.of_type(listed, "parameter_declaration")]
        if any(one is not None and one.type == "identifier" for one in declarators):
            return []
        line = line_of(node)
        return [Declare(line, syntax.text(name), kind, Construct(line, kind, self._reparsed(listed)))]

    def _reparsed(self, node: Node) -> tuple[Expression, ...]:
        """Return the arguments in a parameter list, parsed as an expression at the same place."""
        tree = syntax.parse_range(self._source, node)
        pending = [tree.root_node]
        given: list[Node] = []
        while pending:
            inner = pending.pop(0)
            if inner.type in _SHELLS:
                pending[:0] = inner.named_children
            elif inner.type != "comment":
                given.append(inner)
        return self._expressions.expressions(given)

    def _statements(self, nodes: Iterable[Node]) -> list[Statement]:
        return [statement for node in nodes for statement in self.statement(node)]

    def _if(self, node: Node) -> list[Statement]:
        clause, value = _condition(node)
        begin = clause.child_by_field_name("initializer") if clause is not None else None
        before: list[Statement] = []
        if begin is not None:
            before = self._statements(begin.named_children if begin.type == "init_statement" else [begin])
        condition: Expression = Opaque(line_of(node), "")
        if value is not None and value.type == "declaration":
            declared = self._in_condition(value)
            before += declared
            condition = Name(line_of(value), (declared[0].name,)) if declared else condition
        elif value is not None:
            condition = self._expressions.expression(value)
        arms: list[tuple[Expression | None, Statement]] = [
            (condition, self.block(node.child_by_field_name("consequence")))
        ]
        otherwise = node.child_by_field_name("alternative")
        if otherwise is not None:
            inner = [otherwise]
            if otherwise.type == "else_clause":
                inner = [c for c in otherwise.named_children if c.type != "comment"]
            arms.append((None, Block(line_of(otherwise), tuple(self._statements(inner)))))
        branch = Branch(line_of(node), tuple(arms))
        return [Block(line_of(node), (*before, branch))] if before else [branch]

    def _in_condition(self, node: Node) -> list[Declare]:
        """Return the variable that a condition declares: `if (auto x = f())`."""
        declarator, value = node.child_by_field_name("declarator"), node.child_by_field_name("value")
        name = syntax.declared_name(declarator)
        if name is None:
            return []
        initial = self._expressions.expression(value) if value is not None else None
        return [Declare(line_of(node), syntax.text(name), self._expressions.declared(node, declarator), initial)]

    def _for(self, node: Node) -> list[Statement]:
        begin, condition = node.child_by_field_name("initializer"), node.child_by_field_name("condition")
        step = node.child_by_field_name("update")
        first = self.statement(begin) if begin is not None else []
        iterated = _iterated(first, self._expressions.expression(condition) if condition is not None else None)
        if iterated is not None:
            name, over = iterated
            body = self.block(node.child_by_field_name("body"))
            return [Loop(line_of(node), body, (name,), over, declared=_ELEMENT)]
        return [
            Loop(
                line_of(node),
                self.block(node.child_by_field_name("body")),
                first=Block(line_of(node), tuple(first), open=True),
                condition=self._expressions.expression(condition) if condition is not None else None,
                step=self._expressions.expression(step) if step is not None else None,
            )
        ]

    def _for_range(self, node: Node) -> list[Statement]:
        declarator, over = node.child_by_field_name("declarator"), node.child_by_field_name("right")
        targets = tuple(_names(declarator)) if declarator is not None else ()
        return [
            Loop(
                line_of(node),
                self.block(node.child_by_field_name("body")),
                targets,
                self._expressions.expression(over) if over is not None else Opaque(line_of(node), ""),
                declared=self._expressions.declared(node, declarator),
            )
        ]

    def _while(self, node: Node) -> list[Statement]:
        _, value = _condition(node)
        condition = self._expressions.expression(value) if value is not None and value.type != "declaration" else None
        body = self.block(node.child_by_field_name("body"))
        return [Loop(line_of(node), body, condition=condition, test_last=node.type == "do_statement")]

    def _switch(self, node: Node) -> list[Statement]:
        clause = node.child_by_field_name("condition")
        subject = self._expressions.expression(clause) if clause is not None else Opaque(line_of(node), "")
        body = node.child_by_field_name("body")
        arms: list[tuple[Expression | None, Statement]] = []
        through: list[int] = []
        waiting: list[Expression] = []
        for case in body.named_children if body is not None else ():
            if case.type != "case_statement":
                continue
            value = case.child_by_field_name("value")
            inner = [c for c in case.named_children if value is None or c.id != value.id]
            statements = self._statements(inner)
            test = (
                Binary(line_of(case), "==", (subject, self._expressions.expression(value)))
                if value is not None
                else None
            )
            if not statements and test is not None:
                waiting.append(test)
                continue
            if test is not None and waiting:
                test = Binary(line_of(case), "||", (*waiting, test))
            waiting = []
            if not _leaves(statements):
                through.append(len(arms))
            arms.append((test, Case(line_of(case), tuple(statements))))
        if any(index < len(arms) - 1 for index in through):
            return _in_turn(arms, through)
        arms.sort(key=lambda arm: arm[0] is None)
        return [Branch(line_of(node), tuple(arms))] if arms else []

    def _alias(self, node: Node) -> list[Statement]:
        """Return the names that `using` and `typedef` give to types within a function."""
        kind = node.child_by_field_name("type")
        named = [node.child_by_field_name("name")]
        if node.type == "type_definition":
            named = [syntax.declared_name(one) for one in node.children_by_field_name("declarator")]
        target = self._expressions.type(kind)
        return [Declare(line_of(node), syntax.text(name), None, target) for name in named if name is not None]

    def _return(self, node: Node) -> list[Statement]:
        inner = next((c for c in node.named_children if c.type not in _SKIPPED), None)
        return [Return(line_of(node), self._expressions.expression(inner) if inner is not None else None)]

    def _try(self, node: Node) -> list[Statement]:
        handlers = [self.block(one.child_by_field_name("body")) for one in syntax.of_type(node, "catch_clause")]
        return [Try(line_of(node), self.block(node.child_by_field_name("body")), tuple(handlers))]

    def _preprocessed(self, node: Node) -> list[Statement]:
        condition = node.child_by_field_name("condition")
        otherwise = node.child_by_field_name("alternative")
        skipped = {one.id for one in (condition, otherwise) if one is not None}
        inside = self._statements(child for child in node.named_children if child.id not in skipped)
        if otherwise is not None:
            inside += self.statement(otherwise)
        return inside

    _lowered: ClassVar[dict[str, Callable[[Statements, Node], Sequence[Statement]]]] = {
        "alias_declaration": _alias,
        "type_definition": _alias,
        "compound_statement": lambda self, node: [self.block(node)],
        "expression_statement": _expression_statement,
        "declaration": _declaration,
        "if_statement": _if,
        "for_statement": _for,
        "for_range_loop": _for_range,
        "while_statement": _while,
        "do_statement": _while,
        "switch_statement": _switch,
        "return_statement": _return,
        "break_statement": lambda _, node: [Jump(line_of(node), "break")],
        "continue_statement": lambda _, node: [Jump(line_of(node), "continue")],
        "throw_statement": lambda _, node: [Jump(line_of(node), "raise")],
        "try_statement": _try,
        "labeled_statement": lambda self, node: self._statements(node.named_children),
        **dict.fromkeys(PREPROCESSED, _preprocessed),
    }


def _is_table(one: Declare) -> bool:
    rows = one.type.arguments if one.type is not None and isinstance(one.value, Display) else ()
    return any(isinstance(row, Type) and row.name in _TABLES for row in rows)


def _by_options(node: Node) -> list[Statement]:
    """Return that the variables are set from outside whose addresses a table of options of the command line has."""
    pending, found = [node], list[Node]()
    while pending:
        one = pending.pop()
        pending += one.named_children
        if one.type == "pointer_expression" and syntax.text(one).startswith("&"):
            found += syntax.of_type(one, "identifier")
    return [_set_from_outside(line_of(one), syntax.text(one)) for one in found]


def _set_from_outside(line: int, name: str) -> Step:
    return Step(line, Assign(line, Name(line, (name,)), Opaque(line, f"&{name}")))


def _names(declarator: Node) -> list[str]:
    """Return the variables that a declarator declares."""
    return [syntax.text(name) for name in syntax.captures(_IDENTIFIERS, declarator).get("name", ())]


def _iterated(first: list[Statement], condition: Expression | None) -> tuple[str, Expression] | None:
    """Return iterator and container of `for (it = c.begin(); it != c.end(); ++it)`, where `*it` is an element."""
    match first:
        case [Declare(name=name, value=value) | Step(value=Assign(target=Name(names=(name,)), value=value, sign=""))]:
            pass
        case _:
            return None
    if not (isinstance(value, Call) and isinstance(value.function, Member) and value.function.name in _BEGINNINGS):
        return None
    if not (isinstance(condition, Binary) and condition.sign == "!="):
        return None
    if not any(isinstance(one, Name) and one.names == (name,) for one in condition.operands):
        return None
    return name, value.function.of


def _condition(node: Node) -> tuple[Node | None, Node | None]:
    """Return the clause of the condition of a statement, and its value."""
    clause = node.child_by_field_name("condition")
    if clause is not None and clause.type == "condition_clause":
        return clause, clause.child_by_field_name("value")
    return clause, clause


def _count(declarator: Node) -> int:
    """Return the number of elements of the array that a declarator declares; 0 if that is not a number."""
    size = declarator.child_by_field_name("size") if declarator.type == "array_declarator" else None
    shown = syntax.text(size) if size is not None else ""
    return int(shown) if shown.isdecimal() and int(shown) <= _MOST_STREAMS else 0


def _dimensions(declarator: Node | None) -> int:
    """Return the number of dimensions of the array that a declarator declares; 0 if it declares none."""
    count = 0
    while declarator is not None:
        count += declarator.type == "array_declarator"
        declarator = declarator.child_by_field_name("declarator")
    return count


def _leaves(statements: Sequence[Statement]) -> bool:
    """Return whether a case of a `switch` certainly ends before the next one."""
    last = statements[-1] if statements else None
    if isinstance(last, Block):
        return _leaves(last.body)
    if isinstance(last, Branch):
        return any(test is None for test, _ in last.arms) and all(_leaves([body]) for _, body in last.arms)
    return isinstance(last, Jump | Return)


def _in_turn(arms: list[tuple[Expression | None, Statement]], through: list[int]) -> list[Statement]:
    """Return the cases of a `switch` one after the other: each runs also for those before it that go on with it."""
    tests = [test for test, _ in arms if test is not None]
    statements: list[Statement] = []
    own: list[Expression | None] = []
    for index, (test, body) in enumerate(arms):
        own = [*own, test] if index - 1 in through else [test]
        line = body.line
        others: list[Expression] = [Unary(line, "!", one) for one in tests if one not in own]
        either = tuple(one for one in own if one is not None)
        # The values of other cases exclude it, which says more of a parameter than several that allow it.
        needed = others if len(own) > 1 or index in through or None in own else []
        if None not in own:
            needed.append(Binary(line, "||", either) if len(own) > 1 else either[0])
        condition = needed[0] if len(needed) == 1 else Binary(line, "&&", tuple(needed))
        statements.append(Branch(line, ((condition, body),)) if needed else body)
    return statements
