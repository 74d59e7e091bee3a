"""Making the index of a file: one query, then one sweep over what it captured, in the order of the text."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import count
from typing import TYPE_CHECKING, Final

from kg.extract.python.syntax import captures, code, parse
from kg.extract.python.unit import MODULE, Arms, Binding, CallSite, Import, Scope, Unit

if TYPE_CHECKING:
    from collections.abc import Callable

    from tree_sitter import Node

    from kg.corpus.workspace import FilePath

__all__ = ["index_file"]

_TARGET_LISTS: Final = frozenset({"pattern_list", "tuple_pattern", "list_pattern", "tuple", "list"})
_PLAIN_TARGETS: Final = frozenset({"identifier", "attribute"})
_MAX_UNPACKING: Final = 8
_MAX_SCOPES: Final = 40


@dataclass(frozen=True, slots=True)
class _Loop:
    """The start of a `for`, and the comprehension that its variables stay in."""

    start: int
    within: tuple[int, int] | None = None


_NO_LOOP: Final = _Loop(-1)


def index_file(file: FilePath, source: bytes) -> Unit:
    """Return the index of a file."""
    unit = Unit(file, source)
    root = parse(source).root_node
    unit.module = Scope(MODULE, root, unit, "module", 0, len(source) + 1)
    unit.scopes.append(unit.module)
    _Sweep(unit, captures(root)).run()
    return unit


class _Sweep:
    """Visits captured nodes from first to last and keeps what encloses the present one on stacks."""

    def __init__(self, unit: Unit, found: dict[str, list[Node]]) -> None:
        self.unit = unit
        self.scopes: list[Scope] = [unit.module]
        self.ifs: list[list[int]] = []
        self.arms: list[tuple[int, Arms]] = []
        self.comprehensions: list[tuple[int, int]] = []
        self.decorators: tuple[str, ...] = ()
        order = {kind: rank for rank, kind in enumerate(("decorated", "arm", "except", "if", "class", "function"))}
        number = count()
        self.items = [
            (node.start_byte, -node.end_byte, order.get(kind, 9), next(number), kind, node)
            for kind, nodes in found.items()
            for node in nodes
        ]
        self.items.sort()
        self.visitors: dict[str, Callable[[Node, int, int], None]] = {
            "call": self.call,
            "function": self.function,
            "class": self.klass,
            "assign": self.assign,
            "augment": self.augment,
            "walrus": self.walrus,
            "for": self.loop,
            "clause": self.clause,
            "comprehension": self.comprehension,
            "with": self.with_item,
            "return": self.returned,
            "import": self.imported,
            "global": self.global_names,
            "decorated": self.decorated,
            "if": self.branching,
            "arm": self.arm,
            "except": self.handler,
        }

    def run(self) -> None:
        """Visit everything."""
        for start, negative_end, _, _, kind, node in self.items:
            while start >= self.scopes[-1].end:
                self.scopes.pop()
            while self.arms and start >= self.arms[-1][0]:
                self.arms.pop()
            self.visitors[kind](node, start, -negative_end)

    @property
    def scope(self) -> Scope:
        """The innermost scope around the present node."""
        return self.scopes[-1]

    @property
    def here(self) -> Arms:
        """The branches around the present node, inside of its function."""
        return self.arms[-1][1] if self.arms else ()

    def call(self, node: Node, start: int, end: int) -> None:
        """Note a call under the last word of what is called."""
        del start, end
        called = node.child_by_field_name("function")
        if called is None:
            return
        last = called.child_by_field_name("attribute") if called.type == "attribute" else called
        if last is not None and last.type == "identifier":
            self.scope.calls.append(CallSite(code(last), node, self.here))

    def function(self, node: Node, start: int, end: int) -> None:
        """Open the scope of a function."""
        self.open_scope(node, start, end, "function")

    def klass(self, node: Node, start: int, end: int) -> None:
        """Open the scope of a class."""
        self.open_scope(node, start, end, "class")

    def open_scope(self, node: Node, start: int, end: int, kind: str) -> None:
        """Open a scope inside of the present one; its branches start anew."""
        parent = self.scope
        if len(self.scopes) > _MAX_SCOPES:
            self.unit.too_deep = self.unit.too_deep or node.start_point.row + 1
            return
        name = code(node.child_by_field_name("name"))
        scope = Scope(name, node, self.unit, kind, start, end, parent, self.here, decorators=self.decorators)
        self.decorators = ()
        (parent.classes if kind == "class" else parent.functions)[name] = scope
        parent.holes.append((start, end))
        self.unit.scopes.append(scope)
        self.scopes.append(scope)
        self.arms.append((end, ()))

    def decorated(self, node: Node, start: int, end: int) -> None:
        """Keep the decorators for the definition that follows."""
        del start, end
        names = (code(child)[1:].strip() for child in node.named_children if child.type == "decorator")
        self.decorators = tuple(names)

    def branching(self, node: Node, start: int, end: int) -> None:
        """Note an `if` so that its branches can be numbered."""
        self.unit.ifs[start] = node
        while self.ifs and start >= self.ifs[-1][1]:
            self.ifs.pop()
        self.ifs.append([start, end, 0])

    def arm(self, node: Node, start: int, end: int) -> None:
        """Enter a branch of the innermost `if` that holds it; an empty one behind a broken `if` has none."""
        while self.ifs and start >= self.ifs[-1][1]:
            self.ifs.pop()
        if not self.ifs:
            return
        opened = self.ifs[-1]
        self.arms.append((end, (*self.here, (opened[0], opened[2]))))
        opened[2] += 1
        self.unit.arm_counts[opened[0]] = (opened[2], node.type == "else_clause")

    def handler(self, node: Node, start: int, end: int) -> None:
        """Enter an `except` clause, a branch of its own."""
        del node
        self.arms.append((end, (*self.here, (start, 0))))

    def bind(self, target: Node, value: Node | None, kind: str, start: int, loop: _Loop = _NO_LOOP) -> None:
        """Bind the target of an assignment to its value, part by part where it unpacks."""
        if target.type in _PLAIN_TARGETS:
            self.add(Binding(code(target), kind, value, (), start, self.here, self.scope, loop.start, loop.within))
            return
        pending: list[tuple[Node, tuple[int, ...]]] = [(target, ())]
        while pending:
            node, path = pending.pop()
            if node.type in _TARGET_LISTS and len(path) < _MAX_UNPACKING:
                pending.extend((child, (*path, index)) for index, child in enumerate(node.named_children))
            elif node.type in _PLAIN_TARGETS:
                self.add(Binding(code(node), kind, value, path, start, self.here, self.scope, loop.start, loop.within))
            elif node.type == "subscript":
                self.bind_item(node, value, start)

    def bind_item(self, node: Node, value: Node | None, start: int) -> None:
        """Bind `name[key] = value`."""
        held, key = node.child_by_field_name("value"), node.child_by_field_name("subscript")
        if held is not None and held.type in ("identifier", "attribute"):
            name = code(held) + "[]"
            self.add(Binding(name, "item", value, (), start, self.here, self.scope, key=key))

    def add(self, binding: Binding) -> None:
        """Add a binding to the scope that it is made in."""
        self.scope.bindings.setdefault(binding.name, []).append(binding)

    def assign(self, node: Node, start: int, end: int) -> None:
        """Bind the targets of an assignment; in `a = b = x` every target takes the last value."""
        del start
        left, right = node.child_by_field_name("left"), node.child_by_field_name("right")
        while right is not None and right.type == "assignment":
            right = right.child_by_field_name("right")
        if left is not None and right is not None:
            self.bind(left, right, "assign", end)

    def augment(self, node: Node, start: int, end: int) -> None:
        """Bind the target of `+=` to the whole statement."""
        del start
        left = node.child_by_field_name("left")
        if left is not None and left.type in ("identifier", "attribute"):
            self.bind(left, node, "augment", end)

    def walrus(self, node: Node, start: int, end: int) -> None:
        """Bind the target of `:=`."""
        del start
        name, value = node.child_by_field_name("name"), node.child_by_field_name("value")
        if name is not None:
            self.bind(name, value, "assign", end)

    def loop(self, node: Node, start: int, end: int) -> None:
        """Bind the targets of a `for`."""
        del end
        left, right = node.child_by_field_name("left"), node.child_by_field_name("right")
        if left is not None and right is not None:
            self.bind(left, right, "for", right.end_byte, _Loop(start))

    def comprehension(self, node: Node, start: int, end: int) -> None:
        """Note a comprehension, which its loop variables do not leave."""
        del node
        self.comprehensions.append((start, end))

    def clause(self, node: Node, start: int, end: int) -> None:
        """Bind the targets of a `for` inside of a comprehension."""
        del end
        while self.comprehensions and start >= self.comprehensions[-1][1]:
            self.comprehensions.pop()
        left, right = node.child_by_field_name("left"), node.child_by_field_name("right")
        if left is None or right is None or not self.comprehensions:
            return
        within = self.comprehensions[-1]
        self.bind(left, right, "for", within[0], _Loop(start, within))

    def with_item(self, node: Node, start: int, end: int) -> None:
        """Bind the target of `with value as target`."""
        del start
        pattern = node.named_children[0]
        if pattern.type == "as_pattern" and pattern.named_child_count > 1:
            value, alias = pattern.named_children[0], pattern.named_children[-1]
            for target in alias.named_children:
                self.bind(target, value, "assign", end)

    def returned(self, node: Node, start: int, end: int) -> None:
        """Note what a function returns or yields."""
        del start, end
        if node.named_child_count:
            self.scope.returns.append((node.named_children[0], self.here))

    def global_names(self, node: Node, start: int, end: int) -> None:
        """Note the names that a function takes from its module."""
        del start, end
        self.scope.globals.update(code(child) for child in node.named_children)

    def imported(self, node: Node, start: int, end: int) -> None:
        """Note imports; those inside of functions count for the whole file."""
        self.scope.holes.append((start, end))
        if node.type == "import_statement":
            for child in node.children_by_field_name("name"):
                self.import_module(child)
            return
        module = code(node.child_by_field_name("module_name")).replace(" ", "")
        if any(child.type == "wildcard_import" for child in node.named_children):
            self.unit.stars.append(module)
        for child in node.children_by_field_name("name"):
            name, alias = _import_names(child)
            self.unit.imports.setdefault(alias or name, Import(module, name))

    def import_module(self, node: Node) -> None:
        """Note `import a.b` (which binds `a`) or `import a.b as c`."""
        name, alias = _import_names(node)
        if alias:
            self.unit.imports.setdefault(alias, Import(name, None))
        else:
            first = name.partition(".")[0]
            self.unit.imports.setdefault(first, Import(first, None))


def _import_names(node: Node) -> tuple[str, str | None]:
    if node.type == "aliased_import":
        return code(node.child_by_field_name("name")), code(node.child_by_field_name("alias"))
    return code(node), None
