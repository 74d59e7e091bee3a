"""Python to the intermediate form: statements, functions and classes."""

from __future__ import annotations

from itertools import chain
from typing import TYPE_CHECKING, ClassVar, Final

from kg.extract.python.expressions import YIELDED, Expressions
from kg.extract.python.syntax import argument_nodes, code, line_of
from kg.symbolic.form import (
    Assign,
    Binary,
    Block,
    Branch,
    Call,
    Class,
    Declare,
    Define,
    Display,
    Expression,
    Field,
    Function,
    Import,
    Index,
    Jump,
    Lambda,
    Literal,
    Loop,
    Member,
    Name,
    Return,
    Spread,
    Statement,
    Step,
    Try,
    Unit,
)

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Iterator

    from tree_sitter import Node


DECORATED: Final = "<decorated>"
"""The name of the function that applies a decorator to a function or class."""
_DEEPEST: Final = 60
_OWN: Final = frozenset({"function_definition", "class_definition", "lambda"})
_BROKEN: Final = frozenset({"ERROR", "assignment", "tuple", "parenthesized_expression"})
_CONTEXT: Final = "contextmanager"
"""The end of the names of decorators that make a context manager of a generator."""
_EXITS: Final = frozenset({"sys.exit", "os._exit", "exit", "quit"})
"""Functions that end the program."""
_METHODS: Final = frozenset(
    {"property", "cached_property", "classmethod", "staticmethod", "setter", "deleter", "root_validator", _CONTEXT}
)


class Statements:
    """The statements of one file. `too_deep` is the line of the first one that is nested too deep to be read."""

    def __init__(self, unit: Unit, expressions: Expressions) -> None:
        self._unit = unit
        self._expressions = expressions
        self._depth = 0
        self._scope: tuple[str, ...] = ()
        self._yields = False
        """Whether the function that is lowered is a generator."""
        self.too_deep: int | None = None

    def module(self, root: Node) -> Block:
        """Return the statements of a file."""
        return Block(1, self._of(root.named_children), open=True)

    def body(self, function: Function, node: Node) -> Block:
        """Return the statements of a function; its local variables have no value at first."""
        outer, self._scope = self._scope, (*function.scope, function.name)
        inner = node.child_by_field_name("body")
        around, self._yields = self._yields, inner is not None and _yields(inner)
        statements = self._of(inner.named_children) if inner is not None else ()
        statements = self._generator(function, line_of(node), statements) if self._yields else statements
        self._scope, self._yields = outer, around
        taken = {parameter.name for parameter in function.parameters} | _globals(inner)
        local = [name for name in dict.fromkeys(_assigned(statements)) if name not in taken]
        line = line_of(node)
        return Block(line, (*(Declare(line, name, None, None) for name in local), *statements), open=True)

    @staticmethod
    def _generator(function: Function, line: int, statements: tuple[Statement, ...]) -> tuple[Statement, ...]:
        """Return the statements of a generator, which runs as a function that returns the list of all that it yields.

        A context manager returns the first of them.
        """
        yielded = Name(line, (YIELDED,))
        first = Index(line, yielded, Literal(line, 0.0, "0"))
        result = first if _CONTEXT in function.marks else yielded
        return (Declare(line, YIELDED, None, Display(line, ())), *statements, Return(line, result))

    def _of(self, nodes: Iterable[Node]) -> tuple[Statement, ...]:
        return tuple(chain.from_iterable(self._statement(node) for node in nodes))

    def _block(self, node: Node | None) -> Block:
        """Return the form of a block; it has no scope of its own."""
        if node is None:
            return Block(0, (), open=True)
        return Block(line_of(node), self._of(node.named_children), open=True)

    def _statement(self, node: Node) -> tuple[Statement, ...]:
        lower = self._lowered.get(node.type)
        if lower is None:
            return ()
        if self._depth >= _DEEPEST:
            self.too_deep = self.too_deep or line_of(node)
            return ()
        self._depth += 1
        try:
            return tuple(lower(self, node))
        finally:
            self._depth -= 1

    # Simple statements

    def _step(self, node: Node) -> list[Statement]:
        steps: list[Statement] = []
        for child in node.named_children:
            if child.type == "assignment":
                steps += self._assignment(child)
            elif child.type == "augmented_assignment":
                steps.append(self._augmented(child))
            elif child.type == "ERROR":
                steps += self._broken(child)
            elif child.type not in ("comment", "string", "concatenated_string", "ellipsis"):
                steps.append(Step(line_of(child), self._expressions.expression(child)))
                if child.type == "call" and code(child.child_by_field_name("function")) in _EXITS:
                    steps.append(Jump(line_of(child), "exit"))
        return steps

    def _assignment(self, node: Node) -> list[Statement]:
        """Return the assignments of `a = b = value`, whose value runs once."""
        line = line_of(node)
        targets: list[Expression] = []
        current: Node | None = node
        while current is not None and current.type == "assignment":
            targets.append(self._expressions.expression(current.child_by_field_name("left")))
            current = current.child_by_field_name("right")
        if current is None:
            return []
        value = self._expressions.expression(current)
        if len(targets) > 1:
            shared = Name(line, ("<value>",))
            targets, first, value = [shared, *targets], value, shared
            return [Step(line, Assign(line, one, value if index else first)) for index, one in enumerate(targets)]
        return [Step(line, Assign(line, targets[0], value))]

    def _augmented(self, node: Node) -> Statement:
        line = line_of(node)
        target = self._expressions.expression(node.child_by_field_name("left"))
        value = self._expressions.expression(node.child_by_field_name("right"))
        sign = code(node.child_by_field_name("operator")).removesuffix("=")
        return Step(line, Assign(line, target, value, "true/" if sign == "/" else sign))

    def _values(self, node: Node) -> list[Statement]:
        """Return the expressions of a statement that does nothing else that matters."""
        return [
            Step(line_of(child), self._expressions.expression(child))
            for child in node.named_children
            if child.type not in ("comment", "chevron")
        ]

    def _raise(self, node: Node) -> list[Statement]:
        """Return a `raise`; the program runs in the argument of `raise SystemExit(main())`."""
        runs = code(node).startswith("raise SystemExit(")
        return [*(self._values(node) if runs else ()), Jump(line_of(node), "exit" if runs else "raise")]

    def _broken(self, node: Node) -> list[Statement]:
        """Return the statements and calls in code that does not parse."""
        statements: list[Statement] = []
        for child in node.named_children:
            if child.type == "call":
                statements.append(Step(line_of(child), self._expressions.expression(child)))
            else:
                statements += self._broken(child) if child.type in _BROKEN else self._statement(child)
        return statements

    def _return(self, node: Node) -> list[Statement]:
        inner = next((child for child in node.named_children if child.type != "comment"), None)
        line = line_of(node)
        if self._yields:
            return [Return(line, Name(line, (YIELDED,)))]
        return [Return(line, self._expressions.expression(inner) if inner is not None else Literal(line, None))]

    def _delete(self, node: Node) -> list[Statement]:
        """Return the removal of entries: `del of[key]` as `of.pop(key)`."""
        line = line_of(node)
        targets: list[Node] = []
        for child in node.named_children:
            targets += child.named_children if child.type == "expression_list" else [child]
        expressions = [self._expressions.expression(target) for target in targets]
        indexes = [one for one in expressions if isinstance(one, Index)]
        return [Step(line, Call(line, Member(line, one.of, "pop"), (one.key,))) for one in indexes]

    # Imports

    def _import(self, node: Node) -> list[Statement]:
        imports: list[Statement] = []
        for child in node.children_by_field_name("name"):
            name, alias = _import_names(child)
            imports.append(Step(line_of(node), Import(line_of(node), name, None, alias or "")))
        return imports

    def _import_from(self, node: Node) -> list[Statement]:
        line, module = line_of(node), code(node.child_by_field_name("module_name")).replace(" ", "")
        imports: list[Statement] = []
        if any(child.type == "wildcard_import" for child in node.named_children):
            imports.append(Step(line, Import(line, module, "*", "")))
        for child in node.children_by_field_name("name"):
            name, alias = _import_names(child)
            imports.append(Step(line, Import(line, module, name, alias or name)))
        return imports

    # Compound statements

    def _if(self, node: Node) -> list[Statement]:
        arms: list[tuple[Expression | None, Statement]] = []
        for arm in (node, *node.children_by_field_name("alternative")):
            if arm.type == "else_clause":
                arms.append((None, self._block(arm.child_by_field_name("body"))))
            else:
                condition = self._expressions.expression(arm.child_by_field_name("condition"))
                arms.append((condition, self._block(arm.child_by_field_name("consequence"))))
        return [Branch(line_of(node), tuple(arms))]

    def _for(self, node: Node) -> list[Statement]:
        body = self._block(node.child_by_field_name("body")).body
        over = self._expressions.expression(node.child_by_field_name("right"))
        loop = self._expressions.loop(line_of(node), node.child_by_field_name("left"), over, body)
        return [loop, *self._otherwise(node)]

    def _while(self, node: Node) -> list[Statement]:
        condition = self._expressions.expression(node.child_by_field_name("condition"))
        body = self._block(node.child_by_field_name("body"))
        return [Loop(line_of(node), body, condition=condition), *self._otherwise(node)]

    def _otherwise(self, node: Node) -> list[Statement]:
        other = node.child_by_field_name("alternative")
        return [self._block(other.child_by_field_name("body"))] if other is not None else []

    def _try(self, node: Node) -> list[Statement]:
        body = self._block(node.child_by_field_name("body"))
        handlers: list[Block] = []
        parts: dict[str, Block] = {}
        for child in node.named_children:
            inner = next((part for part in child.named_children if part.type == "block"), None)
            if child.type in ("except_clause", "except_group_clause"):
                handlers.append(self._block(inner))
            elif child.type in ("else_clause", "finally_clause"):
                parts[child.type] = self._block(inner)
        return [Try(line_of(node), body, tuple(handlers), parts.get("else_clause"), parts.get("finally_clause"))]

    def _with(self, node: Node) -> list[Statement]:
        statements: list[Statement] = []
        clause = next((child for child in node.named_children if child.type == "with_clause"), None)
        for item in clause.named_children if clause is not None else ():
            inner = item.named_children[0] if item.named_child_count else None
            if inner is not None and inner.type == "as_pattern" and inner.named_child_count > 1:
                value = self._expressions.expression(inner.named_children[0])
                target = self._expressions.expression(inner.named_children[-1])
                statements.append(Step(line_of(item), Assign(line_of(item), target, value)))
            else:
                statements.append(Step(line_of(item), self._expressions.expression(inner)))
        return [*statements, self._block(node.child_by_field_name("body"))]

    def _match(self, node: Node) -> list[Statement]:
        subject = self._expressions.expression(node.child_by_field_name("subject"))
        arms: list[tuple[Expression | None, Statement]] = []
        body = node.child_by_field_name("body")
        for case in body.named_children if body is not None else ():
            if case.type != "case_clause":
                continue
            pattern = next((child for child in case.named_children if child.type == "case_pattern"), None)
            block = self._block(case.child_by_field_name("consequence"))
            test = self._matches(pattern, subject)
            guard = next((child for child in case.named_children if child.type == "if_clause"), None)
            if guard is not None and guard.named_child_count:
                guarded = self._expressions.expression(guard.named_children[0])
                test = guarded if test is None else Binary(line_of(case), "and", (test, guarded))
            arms.append((test, block))
        return [Branch(line_of(node), tuple(arms))]

    def _matches(self, pattern: Node | None, subject: Expression) -> Expression | None:
        """Return the condition under which a pattern of `match` fits; None if it always does."""
        inner = pattern.named_children[0] if pattern is not None and pattern.named_child_count else None
        if inner is None:
            return None
        line = line_of(inner)
        if inner.type == "dotted_name" and inner.named_child_count == 1:
            bound = Assign(line, Name(line, (code(inner),)), subject)
            return Binary(line, ",", (bound, Literal(line, True)))
        if inner.type == "union_pattern":
            parts = [Binary(line, "==", (subject, self._expressions.expression(one))) for one in inner.named_children]
            return Binary(line, "or", tuple(parts))
        return Binary(line, "==", (subject, self._expressions.expression(inner)))

    # Functions and classes

    def _decorated(self, node: Node) -> list[Statement]:
        inner = node.child_by_field_name("definition")
        decorators = [child.named_children[0] for child in node.named_children if child.type == "decorator"]
        if inner is None:
            return []
        marks = frozenset({_CONTEXT} if any(code(one).endswith(_CONTEXT) for one in decorators) else ())
        defined = self._class_of(inner) if inner.type == "class_definition" else self._function_of(inner, marks)
        for decorator in reversed([one for one in decorators if one.named_child_count or one.type == "identifier"]):
            defined = self._decorate(decorator, defined)
        return [self._named(inner, defined)]

    def _decorate(self, decorator: Node, defined: Expression) -> Expression:
        line = line_of(decorator)
        return Call(line, Name(line, (DECORATED,)), (self._expressions.expression(decorator), defined))

    def _applied(self, cls: Class, node: Node) -> list[Statement]:
        """Return the calls of the decorators of a method, which can register it; the method stays as it is."""
        name = code((node.child_by_field_name("definition") or node).child_by_field_name("name"))
        method = next(iter(cls.methods.get(name, ())), None)
        if method is None or "decorated" not in method.marks:
            return []
        decorators = [child.named_children[0] for child in node.named_children if child.type == "decorator"]
        defined = Lambda(line_of(node), method)
        return [Step(line_of(one), self._decorate(one, defined)) for one in reversed(decorators)]

    def _named(self, node: Node, value: Expression) -> Statement:
        line, name = line_of(node), code(node.child_by_field_name("name"))
        return Step(line, Assign(line, Name(line, (name,)), value))

    def _function_of(self, node: Node, marks: frozenset[str] = frozenset()) -> Expression:
        return Lambda(line_of(node), self._read(node, self._scope, marks))

    def _read(self, node: Node, scope: tuple[str, ...], marks: frozenset[str] = frozenset()) -> Function:
        parameters = self._expressions.parameters(node)
        name = code(node.child_by_field_name("name"))
        static = "staticmethod" in marks
        return Function(self._unit, name, scope, parameters, line_of(node), static=static, marks=marks, source=node)

    def _class_of(self, node: Node) -> Expression:
        """Return the definition of a class: the methods in its body are members, all other statements run."""
        name, line = code(node.child_by_field_name("name")), line_of(node)
        cls = Class(self._unit, name, self._scope, line)
        bases = [one for one in argument_nodes(node) if one.type != "keyword_argument"]
        cls.derived = tuple(self._expressions.expression(base) for base in bases)
        outer, self._scope = self._scope, (*self._scope, name)
        body = node.child_by_field_name("body")
        statements: list[Statement] = []
        for child in body.named_children if body is not None else ():
            if self._method(cls, child):
                statements += self._applied(cls, child)
            else:
                statements += self._statement(child)
                cls.fields.update((name, Field(name, None, None, line_of(child))) for name in _annotated(child))
        self._scope = outer
        own = (Declare(line, one, None, None) for one in dict.fromkeys(_assigned(statements)))
        cls.body = Block(line, (*own, *statements), open=True)
        return Define(line, cls)

    def _method(self, cls: Class, node: Node) -> bool:
        """Add a method to its class; return False for other statements."""
        inner: Node | None = node
        marks: frozenset[str] = frozenset()
        if node.type == "decorated_definition":
            inner = node.child_by_field_name("definition")
            names = [code(child)[1:].strip() for child in node.named_children if child.type == "decorator"]
            marks = frozenset(name.rpartition(".")[2] for name in names) & _METHODS
            if not marks and inner is not None and inner.type == "function_definition":
                marks = frozenset({"decorated"})
        if inner is None or inner.type != "function_definition":
            return False
        if not marks & {"setter", "deleter"}:
            function = self._read(inner, self._scope, marks)
            function.owner = cls
            cls.methods[function.name] = [function]
        return True

    _lowered: ClassVar[dict[str, Callable[[Statements, Node], Iterable[Statement]]]] = {
        "expression_statement": _step,
        **dict.fromkeys(("print_statement", "assert_statement", "exec_statement"), _values),
        "ERROR": _broken,
        "delete_statement": _delete,
        "return_statement": _return,
        "raise_statement": _raise,
        "break_statement": lambda _, node: [Jump(line_of(node), "break")],
        "continue_statement": lambda _, node: [Jump(line_of(node), "continue")],
        "import_statement": _import,
        "import_from_statement": _import_from,
        "if_statement": _if,
        "for_statement": _for,
        "while_statement": _while,
        "try_statement": _try,
        "with_statement": _with,
        "match_statement": _match,
        "decorated_definition": _decorated,
        "function_definition": lambda self, node: [self._named(node, self._function_of(node))],
        "class_definition": lambda self, node: [self._named(node, self._class_of(node))],
    }


def _import_names(node: Node) -> tuple[str, str | None]:
    if node.type == "aliased_import":
        return code(node.child_by_field_name("name")), code(node.child_by_field_name("alias"))
    return code(node), None


def _globals(body: Node | None) -> set[str]:
    """Return the names that a function takes from around it by `global` or `nonlocal`."""
    names: set[str] = set()
    pending = list(body.named_children) if body is not None else []
    while pending:
        node = pending.pop()
        if node.type in ("global_statement", "nonlocal_statement"):
            names.update(code(child) for child in node.named_children)
        elif node.type in _HOLDERS:
            pending += node.named_children
    return names


_HOLDERS: Final = frozenset(
    {
        "block", "if_statement", "elif_clause", "else_clause", "for_statement", "while_statement", "try_statement",
        "except_clause", "finally_clause", "with_statement",
    }
)  # fmt: skip


def _yields(node: Node) -> bool:
    """Check whether the body of a function yields values itself."""
    if b"yield" not in (node.text or b""):
        return False
    inner = (child for child in node.named_children if child.type not in _OWN)
    return node.type == "yield" or any(_yields(child) for child in inner)


def _annotated(node: Node) -> Iterator[str]:
    """Yield the name that a statement in the body of a class gives a type: a field of a data class."""
    for child in node.named_children:
        if child.type == "assignment" and child.child_by_field_name("type") is not None:
            yield code(child.child_by_field_name("left"))


def _assigned(statements: Iterable[Statement]) -> Iterable[str]:
    """Yield the names that statements assign, in order."""
    for one in statements:
        if isinstance(one, Step):
            if isinstance(one.value, Assign):
                yield from _targets(one.value.target)
            elif isinstance(one.value, Import):
                yield one.value.alias or one.value.module.partition(".")[0]
        elif isinstance(one, Block):
            yield from _assigned(one.body)
        elif isinstance(one, Branch):
            for _, body in one.arms:
                yield from _assigned((body,))
        elif isinstance(one, Loop):
            yield from one.targets
            yield from _assigned((one.body,))
        elif isinstance(one, Try):
            blocks = (one.body, *one.handlers, one.otherwise, one.last)
            yield from _assigned(block for block in blocks if block is not None)


def _targets(target: Expression) -> Iterable[str]:
    if isinstance(target, Name):
        yield target.names[0]
    elif isinstance(target, Spread):
        yield from _targets(target.of)
    elif isinstance(target, Display):
        for item in target.items:
            yield from _targets(item)
