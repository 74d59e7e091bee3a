"""Where the value of a name in a function or class comes from: back through assignments, parameters and members.

Within a function writes are followed upwards from the use; a write that must have happened ends the search,
one in a branch is an alternative. A member has the values that any method of its class family leaves in it;
values read from ROS parameters go before plain ones, since those are their defaults.
"""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, Final, TypeAlias

from kg.extract.cpp import syntax
from kg.extract.cpp.api import ARGUMENT_LISTS
from kg.extract.cpp.context import Site
from kg.extract.cpp.objects import OBJECT, emplaced, of_object
from kg.extract.cpp.sites import accepts, fits
from kg.extract.cpp.unit import Expr, read_parameters
from kg.extract.cpp.variables import WriteKind, writes
from kg.extract.values import COMMAND_LINE, Handle, Mapping, Number, Sequence, Text, Unknown, Value, concatenate
from kg.facts import Resolution

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable

    from tree_sitter import Node

    from kg.extract.cpp.context import Context
    from kg.extract.cpp.evaluate import Alternatives, Evaluator
    from kg.extract.cpp.unit import Class, Function, Unit
    from kg.extract.cpp.variables import Write

_Call: TypeAlias = "tuple[syntax.Callee, list[Expr], list[tuple[Function, list[Write]]]]"
__all__ = ["Flow", "settled", "unfinished"]

_MOST_TURNS: Final = 64
_COUNTERS: Final = ("init_declarator", "assignment_expression")
"""What gives the counter of a loop its first value."""


class Flow:
    """Follows names for an evaluator."""

    def __init__(self, evaluator: Evaluator) -> None:
        self._evaluator = evaluator
        self._program = evaluator.program
        self._calls: dict[Write, _Call | None] = {}

    def name(self, name: str, where: Expr, context: Context, *, member: bool = False) -> Alternatives:
        """Return what a plain name can be where it stands."""
        unit, at = where.unit, where.at
        function = unit.function_at(at)
        if function is not None and not member:
            local = [w for w in writes(unit, name, function.start, function.end) if w.owner is None]
            declared = [index for index, write in enumerate(local) if _declares(write, at)]
            if declared:
                own = local[declared[-1] :]  # what stands before is of another variable of that name
                return self.back(own, at, context) or [(Unknown(f"{name} has no value in sight"), context)]
        cls = self._evaluator.types.class_around(unit, at)
        if cls is not None:
            found = self._member(cls, name, where, context)
            if found is not None:
                return found
        return self._evaluator.constants.find(name, (), where, context)

    def back(
        self, found: list[Write], at: int, context: Context, kinds: frozenset[WriteKind] | None = None
    ) -> Alternatives:
        """Return the values that the writes before a byte leave, latest first."""
        before = [w for w in found if (w.name.start_byte < at and not w.node.start_byte <= at < w.end) or _loops(w, at)]
        relevant = [i for i in range(len(before)) if kinds is None or before[i].kind in kinds]
        settling = [i for i in relevant if before[i].within[0] <= at < before[i].within[1]]
        if not relevant:
            return []
        last = before[-1]
        key = ("back", last.unit, last.name.start_byte, before[0].name.start_byte, len(before), kinds, tuple(settling))
        evaluator = self._evaluator
        return evaluator.recalled(key, context, lambda: self._latest(before, relevant, frozenset(settling), context))

    def _latest(
        self, before: list[Write], relevant: list[int], settling: frozenset[int], context: Context
    ) -> Alternatives:
        result: Alternatives = []
        handed_out = False
        for index in reversed(relevant):
            write = before[index]
            values = self.written(write, context, before[:index])
            if values is None:
                handed_out = handed_out or write.kind is WriteKind.OUTPUT
                continue
            if write.kind is WriteKind.DECLARE and any(isinstance(value, Text) for value, _ in values):
                if handed_out and not result:
                    reason = f"{syntax.text(write.name)} is set by a call that is not in the sources that were read"
                    result.append((Unknown(reason), context))
                values = [] if result else values
            result += values
            if index in settling:
                break
        return settled(result)

    def written(self, write: Write, context: Context, earlier: list[Write]) -> Alternatives | None:
        """Return the values that one write leaves, `earlier` being those before it; None if it is none after all."""
        evaluator = self._evaluator
        kind = write.kind
        if kind is WriteKind.VALUE:
            return self._turns(write, context) or self._typed(write, context)
        if kind is WriteKind.CONSTRUCT:
            return self._constructed(write, context)
        if kind is WriteKind.COUNT:
            return [(Unknown(f"{syntax.text(write.name)} counts the turns of a loop"), context)]
        if kind is WriteKind.READ:
            return [(Unknown(f"{syntax.text(write.name)} is read from a stream"), context)]
        if kind is WriteKind.APPEND:
            before = self.back(earlier, write.name.start_byte, context) or [(Text.of(""), context)]
            pairs = [(v, w, c2) for v, c in before for w, c2 in evaluator.values(write.value, c)]
            return [(concatenate(v, w), c) for v, w, c in pairs]
        if kind is WriteKind.INSERT:
            return self._inserted(write, context, earlier)
        if kind is WriteKind.ELEMENT:
            return self._elements(write, context)
        if kind is WriteKind.PARAMETER:
            return self._parameter(write, context)
        if kind is WriteKind.OUTPUT:
            given = [w for w in earlier if w.kind is not WriteKind.DECLARE]
            return self.output(write, context, lambda c: self.back(given, write.name.start_byte, c))
        return self._declared(write, context)

    def _typed(self, write: Write, context: Context) -> Alternatives:
        """Return the value of `Type name = value`, which makes a `Type` of the value."""
        evaluator = self._evaluator
        declarator = write.name.parent
        array = declarator is not None and declarator.type == "array_declarator"
        if write.node.type == "initializer_list" and write.type is not None and not array:
            for kind, chosen in evaluator.types.settle(Expr.of(write.unit, write.type), context):
                given = [write.value.child(n) for n in syntax.arguments(write.node)]
                made = evaluator.construct(kind, given, chosen)
                if made is not None:
                    return made
        return evaluator.values(write.value, context)

    def _constructed(self, write: Write, context: Context) -> Alternatives:
        evaluator = self._evaluator
        value = write.node
        nodes = write.unit.reparse(value) if value.type == "parameter_list" else syntax.arguments(value)
        given = [Expr.of(write.unit, node) for node in nodes]
        declared = write.type
        where = Expr.of(write.unit, write.name)
        if declared is not None and declared.type == "placeholder_type_specifier":
            return evaluator.values(given[0], context) if given else [(Unknown("no value"), context)]
        if declared is not None:
            settled = evaluator.types.settle(Expr.of(write.unit, declared), context)
        else:
            kind = evaluator.types.of(where, context)
            settled = [(kind, context)] if kind is not None else []
        for kind, chosen in settled:
            made = evaluator.construct(kind, given, chosen)
            if made is not None:
                return made
        if len(given) == 1:
            return evaluator.values(given[0], context)
        return [(Unknown(f"{syntax.text(write.name)} is an object"), context)]

    def _declared(self, write: Write, context: Context) -> Alternatives | None:
        evaluator = self._evaluator
        if write.type is None:
            return None
        for kind, chosen in evaluator.types.settle(Expr.of(write.unit, write.type), context):
            if "*" not in syntax.text(write.node).split(syntax.text(write.name))[0]:
                return evaluator.construct(kind, [], chosen)
        return None

    def _inserted(self, write: Write, context: Context, earlier: list[Write]) -> Alternatives:
        evaluator = self._evaluator
        before = self.back(earlier, write.name.start_byte, context) or [(Sequence(()), context)]
        if write.node.type == "assignment_expression":
            left, right = write.node.child_by_field_name("left"), write.node.child_by_field_name("right")
            keys = syntax.arguments(left.child_by_field_name("indices")) if left is not None else []
            given = [*keys, right] if right is not None else keys
        else:
            given = syntax.arguments(write.node.child_by_field_name("arguments"))
        rows = evaluator.product([Expr.of(write.unit, node) for node in given], context)
        found: Alternatives = []
        for held, _ in before:
            for row, chosen in rows:
                found.append((_with(held, row), chosen))
        return found

    def _elements(self, write: Write, context: Context) -> Alternatives | None:
        evaluator = self._evaluator
        point = ("loop", write.unit, write.node.start_byte)
        found: Alternatives = []
        for value, chosen in evaluator.values(write.value, context):
            items: tuple[Value, ...]
            if isinstance(value, Mapping):
                items = tuple(Sequence(pair) for pair in value.items)
            elif isinstance(value, Sequence):
                items = value.items
            else:
                found.append((Unknown("the elements of the container are not known"), chosen))
                continue
            taken = chosen.get(point)
            for number, item in enumerate(items):
                if taken is None or taken == number:
                    part = item.items[write.index] if write.index >= 0 and isinstance(item, Sequence) else item
                    found.append((part, chosen.bind(point, number)))
        return found

    def _turns(self, write: Write, context: Context) -> Alternatives | None:
        """Return the values of the counter of a loop; None for other variables."""
        declaration = write.name.parent
        loop = next((p for p in syntax.outward(write.name, 4) if p.type == "for_statement"), None)
        head = loop.child_by_field_name("initializer") if loop is not None else None
        if loop is None or declaration is None or declaration.type not in _COUNTERS:
            return None
        if head is None or not head.start_byte <= write.name.start_byte < head.end_byte:
            return None
        condition = loop.child_by_field_name("condition")
        limit = condition.child_by_field_name("right") if condition is not None else None
        if condition is None or limit is None:
            return [(Unknown("it is the counter of a loop"), context)]
        point = ("loop", write.unit, loop.start_byte)
        inclusive = "<=" in syntax.text(condition)
        found: Alternatives = []
        for (first, last), chosen in (
            (row, c) for row, c in self._evaluator.product([write.value, Expr.of(write.unit, limit)], context)
        ):
            if not isinstance(first, Number) or not isinstance(last, Number) or last.value - first.value > _MOST_TURNS:
                found.append((Unknown("it is the counter of a loop whose end is not known"), chosen))
                continue
            taken = chosen.get(point)
            for turn in range(int(first.value), int(last.value) + inclusive):
                if taken is None or taken == turn:
                    found.append((Number(float(turn), str(turn)), chosen.bind(point, turn)))
        return found

    def output(
        self, write: Write, context: Context, previous: Callable[[Context], Alternatives]
    ) -> Alternatives | None:
        """Return what a call leaves in an argument; None if the call is not known to write it."""
        evaluator = self._evaluator
        known = self._call_of(write)
        if known is None:
            return None
        called, given, targets = known
        call = Expr.of(write.unit, write.node)
        found = evaluator.api.output(evaluator, call, called, given, write.index, context, previous)
        if found is not None:
            return found
        for function, inside in targets:
            if context.get(function) is None:
                site = Site(call, tuple(given), (), context)
                left = self.back(inside, function.end - 1, context.bind(function, site).deeper())
                if left:
                    return [(value, context) for value, _ in left]
        return None

    def _call_of(self, write: Write) -> _Call | None:
        """Return the call that an argument is handed to, and the functions that write it; None where nothing does."""
        if write not in self._calls:
            self._calls[write] = None
            self._calls[write] = self._read_call(write)
        return self._calls[write]

    def _read_call(self, write: Write) -> _Call | None:
        function = write.node.child_by_field_name("function")
        called = syntax.callee(function) if function is not None else None
        if called is None:
            return None
        call = Expr.of(write.unit, write.node)
        given = [call.child(a) for a in syntax.arguments(write.node.child_by_field_name("arguments"))]
        targets = []
        for other in self._meant(called, call):
            if write.index < len(other.parameters) and fits(other, len(given)) and _mutable(other, write.index):
                everything = writes(other.unit, other.parameters[write.index].name, other.start, other.end)
                inside = [w for w in everything if w.owner is None and w.kind is not WriteKind.PARAMETER]
                inside = [w for w in inside if w.kind is not WriteKind.OUTPUT or self._call_of(w) is not None]
                if inside:
                    targets.append((other, inside))
        read = ARGUMENT_LISTS.get(called.name) == write.index or any(
            spec.output == write.index for spec in self._evaluator.api.parameters.get(called.name, ())
        )
        return (called, given, targets) if targets or read else None

    def _meant(self, called: syntax.Callee, call: Expr) -> list[Function]:
        """Return the functions that a call may mean; a bare name in a class means its own before those of others."""
        program = self._program
        found = program.functions(called.name, call.unit)
        if len(found) > 1 and called.receiver is None and not called.scope:
            around = self._evaluator.types.class_around(call.unit, call.at)
            if around is not None:
                related = {*program.family(around), *program.derived(around)}
                found = [function for function in found if program.owner(function) in related] or found
        return found

    def _parameter(self, write: Write, context: Context) -> Alternatives:
        unit = write.unit
        name = syntax.text(write.name)
        for outer in syntax.outward(write.node, 4):
            if outer.type == "lambda_expression":
                return self._lambda(unit, outer, write, context)
        function = unit.function_at(write.name.start_byte)
        if function is None:
            return [(Unknown(f"{name} is a parameter"), context)]
        index = next((i for i, p in enumerate(function.parameters) if p.name == name), None)
        if index is None:
            return [(Unknown(f"{name} is a parameter"), context)]
        return self._from_sites(function, index, context)

    def entries(self, function: Function, context: Context) -> list[tuple[Site, Context]]:
        """Return the calls that can have led into a function: the one chosen before, or each of them."""
        chosen = context.get(function)
        if isinstance(chosen, Site):
            return [(chosen, context)]
        owner = self._program.owner(function)
        sites = self._evaluator.sites
        constructor = owner is not None and function.name == owner.name
        found = sites.constructions(owner) if constructor and owner is not None else sites.calls(function)
        entered = [
            (site, context.bind(function, site))
            for site in (
                of_object(self._program, found, owner, context) if constructor and owner is not None else found
            )
            if fits(function, len(site.arguments)) and accepts(function, site.arguments)
        ]
        return entered or (
            list(emplaced(self._evaluator, function, owner, context)) if constructor and owner is not None else []
        )

    def _from_sites(self, function: Function, index: int, context: Context) -> Alternatives:
        evaluator = self._evaluator
        candidates = self.entries(function, context)
        result: Alternatives = []
        for site, bound in candidates:
            if index < len(site.arguments):
                argument = site.arguments[index]
                if site.context is not None:
                    inner = evaluator.values(argument, site.context.at(context.depth))
                    result += [(value, bound) for value, _ in inner]
                else:
                    result += evaluator.values(argument, bound)
            else:
                default = self._default(function, index)
                result += evaluator.values(default, bound) if default is not None else []
        if result:
            return result
        name = function.parameters[index].name
        namespace = evaluator.api.given_argument(function.name, len(function.parameters), index)
        if namespace is not None and evaluator.types.is_handle(function.parameters[index].type, function.unit):
            return [(Handle(Text.of(namespace)), context)]
        if function.name == "main":
            return [(COMMAND_LINE, context)]
        return [(Unknown(f"no call of {function.name} that gives {name} is in the code that was read"), context)]

    def _default(self, function: Function, index: int) -> Expr | None:
        own = function.parameters[index].default
        if own is not None:
            return Expr.of(function.unit, own)
        owner = self._program.owner(function)
        if owner is None:
            return None
        body = owner.node.child_by_field_name("body")
        for member in body.named_children if body is not None else ():
            declarator = member.child_by_field_name("declarator")
            if declarator is not None and declarator.type == "function_declarator":
                named = syntax.declared_name(declarator)
                if named is not None and syntax.text(named) == function.name:
                    listed = read_parameters(declarator)
                    default = listed[index].default if index < len(listed) else None
                    if default is not None:
                        return Expr.of(owner.unit, default)
        return None

    def _lambda(self, unit: Unit, node: Node, write: Write, context: Context) -> Alternatives:
        """Return what the calls of a local lambda give for a parameter."""
        declarator = node.parent
        named = (
            syntax.declared_name(declarator)
            if declarator is not None and declarator.type == "init_declarator"
            else None
        )
        inner = node.child_by_field_name("declarator")
        parameters = read_parameters(inner) if inner is not None else ()
        name = syntax.text(write.name)
        index = next((i for i, p in enumerate(parameters) if p.name == name), None)
        if named is None or index is None:
            return [(Unknown(f"{name} is a parameter of a function without a name"), context)]
        key = ("lambda", unit, node.start_byte)
        chosen = context.get(key)
        sites: list[tuple[Site, Context]] = [(chosen, context)] if isinstance(chosen, Site) else []
        if not sites:
            for use in unit.occurrences(syntax.text(named)):
                call = use.parent
                if call is not None and call.type == "call_expression" and use.start_byte > node.end_byte:
                    given = syntax.arguments(call.child_by_field_name("arguments"))
                    site = Site(Expr.of(unit, call), tuple(Expr.of(unit, a) for a in given))
                    sites.append((site, context.bind(key, site)))
        found = [
            pair for s, c in sites if index < len(s.arguments) for pair in self._evaluator.values(s.arguments[index], c)
        ]
        return found or [(Unknown(f"{name} is a parameter of a function without a name"), context)]

    def _member(self, cls: Class, name: str, where: Expr, context: Context) -> Alternatives | None:
        """Return the values of a member of a class family; None if there is no such member."""
        family = list(self._program.family(cls))
        function = where.unit.function_at(where.at)
        if function is not None:
            here = [w for w in writes(where.unit, name, function.start, function.end) if w.owner is None]
            settled = [w for w in here if w.name.start_byte < where.at and w.within[0] <= where.at < w.within[1]]
            found = self.back(here, where.at, context) if settled else []
            if found and not unfinished(found):
                return found
        key = ("member", cls, name)
        if context.get(key):
            return [(Unknown(f"{name} depends on itself"), context)]
        found = self._evaluator.recalled(key, context, lambda: self._anywhere(family, cls, name, context))
        given = self._handed_down(family, name) if unfinished(found) else None
        if given is not None:
            return [(given, context)]
        if not found and not any(name in base.fields for base in family):
            return None
        return found or [(Unknown(f"{name} is given no value in the code that was read"), context)]

    def _handed_down(self, family: list[Class], name: str) -> Handle | None:
        """Return the handle that a base class outside of the build keeps in a member."""
        bases = [syntax.simple_name(base) for cls in family for base in cls.bases]
        namespace = self._evaluator.api.given_member(bases, name)
        return Handle(Text.of(namespace)) if namespace is not None else None

    def _anywhere(self, family: list[Class], cls: Class, name: str, context: Context) -> Alternatives:
        """Return the values that any method of a class family, or the declaration, gives a member."""
        key = ("member", cls, name)
        outer = context.get(OBJECT)
        inner = context.bind(key, True).bind(OBJECT, cls)
        everyone = [*family, *self._program.derived(cls)]
        found = self.left(everyone, name, inner)
        declared = next((base for base in family if name in base.fields), None)
        if declared is not None and (not found or unfinished(found)):
            found += self.initial(declared, name, inner)
        return [(value, chosen.bind(key, None).bind(OBJECT, outer)) for value, chosen in settled(found)]

    def left(self, classes: Iterable[Class], name: str, context: Context) -> Alternatives:
        """Return what the methods of some classes leave in a member."""
        found: Alternatives = []
        for cls in classes:
            for function in self._program.methods(cls):
                if function in self._program.reached:
                    here = [w for w in writes(function.unit, name, function.start, function.end) if w.owner is None]
                    if here and not any(w.type is not None for w in here):
                        found += self.back(here, function.end - 1, context)
        return found

    def initial(self, cls: Class, name: str, context: Context) -> Alternatives:
        """Return the value that the declaration of a member gives it."""
        for write in writes(cls.unit, name, cls.start, cls.end):
            if write.type is not None and cls.unit.function_at(write.name.start_byte) is None:
                found = self.written(write, context, []) or []
                empty = write.kind is WriteKind.DECLARE
                kept = [pair for pair in found if not (empty and isinstance(pair[0], Text))]
                return kept or self._defined(cls, name, context)
        return []

    def _defined(self, cls: Class, name: str, context: Context) -> Alternatives:
        """Return the value of a static member from its definition outside of the class."""
        for unit in dict.fromkeys([cls.unit, *(method.unit for method in self._program.methods(cls))]):
            for write in writes(unit, name, 0, len(unit.source)):
                outer = write.name.parent
                qualified = outer is not None and outer.type == "qualified_identifier"
                if qualified and write.type is not None and unit.function_at(write.name.start_byte) is None:
                    return self.written(write, context, []) or []
        return []

    def field(self, name: str, holder: Expr, where: Expr, context: Context) -> Alternatives:
        """Return the value of a member of another object: what is written to it through objects of that type."""
        evaluator = self._evaluator
        cls = evaluator.types.class_of(evaluator.types.of(holder, context))
        key = ("field", cls, name)
        if context.get(key):
            return [(Unknown(f"{name} depends on itself"), context)]
        inner = context.bind(key, True)
        wanted = syntax.text(holder.node).removeprefix("this->")
        found: Alternatives = []
        for unit in tuple(self._program.units.values()):
            for write in writes(unit, name, 0, len(unit.source)):
                if write.owner is None or not self._program.runs(unit, write.name.start_byte):
                    continue
                same = syntax.text(write.owner).removeprefix("this->") == wanted and (
                    cls is not None or unit is where.unit
                )
                if not same and cls is not None:
                    same = evaluator.types.class_of(evaluator.types.of(Expr.of(unit, write.owner), context)) is cls
                if same:
                    found += self.written(write, inner, []) or []
        for base in self._program.family(cls) if cls is not None else ():
            if name in base.fields and (not found or unfinished(found)):
                found += self.left([base], name, inner) or self.initial(base, name, inner)
        found = [(value, chosen.bind(key, None)) for value, chosen in settled(found)]
        return found or [
            (Unknown(f"the member {name} of {wanted} is given no value in the code that was read"), context)
        ]


def _declares(write: Write, at: int) -> bool:
    declares = write.type is not None or write.kind in (WriteKind.PARAMETER, WriteKind.ELEMENT)
    return declares and write.name.start_byte < at and at < max(write.within[1], write.end)


def _loops(write: Write, at: int) -> bool:
    """Tell whether a byte stands in a loop whose head holds the write, or which counts the variable on."""
    if write.kind is WriteKind.COUNT:
        return write.within[0] <= at < write.within[1]
    return write.kind is WriteKind.ELEMENT and write.name.start_byte < at


def _mutable(function: Function, index: int) -> bool:
    declarator = function.declarator
    listed = syntax.arguments(declarator.child_by_field_name("parameters")) if declarator is not None else []
    if index >= len(listed):
        return False
    written = syntax.text(listed[index])
    return ("&" in written or "*" in written) and not written.startswith("const ")


def _with(held: Value, row: list[Value]) -> Value:
    """Return a container with one element, or one pair of key and value, more."""
    if len(row) == 1:
        items = held.items if isinstance(held, Sequence) else ()
        inner = row[0]
        return Sequence((*items, inner))
    if len(row) == 2:  # noqa: PLR2004 - key and value
        pairs = held.items if isinstance(held, Mapping) else ()
        return Mapping((*pairs, (row[0], row[1])))
    return held


def _known(value: Value) -> bool:
    if isinstance(value, Text):
        return value.known is not None
    return not isinstance(value, Unknown)


def unfinished(found: Alternatives) -> bool:
    """Tell whether no value is known, or only that a parameter without a default is read."""
    return not any(_known(value) for value, _ in found)


def settled(found: Alternatives) -> Alternatives:
    """Return alternatives where what a parameter without default falls back to carries the parameter's name."""
    asked = [v for v, _ in found if isinstance(v, Text) and v.parameter is not None and v.known is None]
    plain = [(v, c) for v, c in found if _known(v)]
    if asked and plain:
        parameter = asked[0].parameter
        return [
            (replace(v, resolution=Resolution.PARAMETER_DEFAULT, parameter=v.parameter or parameter), c)
            if isinstance(v, Text) and v.known
            else (v, c)
            for v, c in plain
            if not (isinstance(v, Text) and v.known == "")
        ] or [(v, c) for v, c in found if not (isinstance(v, Text) and v.known == "")]
    if any(isinstance(v, Text) and v.known for v, _ in found):
        return [(v, c) for v, c in found if not (isinstance(v, Text) and v.known == "" and v.parameter is None)]
    return found
