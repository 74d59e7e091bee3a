"""Lists, dictionaries, profiles: what iteration, keys and later statements make of them."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

from kg.extract.python.arguments import read_arguments
from kg.extract.python.conditions import Conditions
from kg.extract.python.core import COMPUTED
from kg.extract.python.entities import (
    ArgumentsParsed,
    Dotted,
    Items,
    QosValue,
    Table,
    plain,
)
from kg.extract.python.flow import END
from kg.extract.python.qos import FIELDS, changed, quality
from kg.extract.python.syntax import code
from kg.extract.values import (
    COMMAND_LINE,
    HOLE,
    Number,
    Text,
    Unknown,
    argument_at,
    is_whole_parameter,
    part_of_parameter,
)

if TYPE_CHECKING:
    from collections.abc import Iterator

    from tree_sitter import Node

    from kg.extract.python.entities import Alternatives, Choice, Frame, Thing
    from kg.extract.python.unit import Binding

__all__ = ["Containers", "unpacked"]

_MAX_ROUNDS: Final = 24


class Containers(Conditions):
    """The part of the evaluator that takes containers apart."""

    def completed(self, value: Thing, binding: Binding, frame: Frame) -> Thing:
        """Return a value with what statements after its making add to it: elements of a list, policies of a profile."""
        if isinstance(value, Items) and not value.items:
            return Items(tuple(self.appended(binding, frame)))
        return self.refined(value, binding, frame) if isinstance(value, QosValue | Dotted) else value

    def appended(self, binding: Binding, frame: Frame) -> Iterator[Thing]:
        """Yield what is appended to a list that was made empty, in its scope or, for attributes, in its class."""
        owner = binding.scope.owner if "." in binding.name else None
        for scope in owner.functions.values() if owner is not None else (binding.scope,):
            calls = [call for call in scope.calls if call.name == "append" and _held(call.node) == binding.name]
            frames = [frame] if scope is binding.scope else self.frames_of(scope, frame.instance) if calls else []
            for call in calls:
                for where in frames:
                    argument = read_arguments(call.node, where).get(0)
                    yield from (value for value, _ in self.thunk(argument, {})) if argument is not None else ()

    def refined(self, value: QosValue | Dotted, binding: Binding, frame: Frame) -> Thing:
        """Return a profile or preset with the policies that are assigned to its attributes; anything else as it is."""
        start, changes = quality(value), {}
        for field in FIELDS if start is not None else ():
            later = binding.scope.bindings.get(f"{binding.name}.{field}")
            if later:
                changes[field] = self.bound(later, END, frame, {})[0][0][0]
        after = changed(start, changes) if start is not None and changes else None
        return QosValue(after) if after is not None else COMPUTED if changes else value

    def each_round(self, binding: Binding, value: Thing, frame: Frame, choice: Choice) -> Alternatives:
        """Return what a loop variable takes, round by round, or in the round that was chosen."""
        rounds, key = self.rounds(value), (frame.id, binding.loop)
        if rounds is None:
            return [(part_of(value), choice)]
        if key in choice:
            return [(rounds[choice[key]], choice)] if choice[key] < len(rounds) else []
        return [(item, {**choice, key: index}) for index, item in enumerate(rounds)]

    def rounds(self, value: Thing) -> list[Thing] | None:
        """Return what iterating over a value gives; None when that is not known."""
        if isinstance(value, Items):
            return list(value.items[:_MAX_ROUNDS])
        if isinstance(value, Table):
            return [key for key, _ in value.items[:_MAX_ROUNDS]]
        if isinstance(value, Text) and is_whole_parameter(value):
            return [part_of_parameter(value, COMPUTED)]
        return None

    def item(self, value: Thing, key: Thing, node: Node, frame: Frame, choice: Choice) -> Alternatives:
        """Return `value[key]`, `node` being the whole expression."""
        held = node.child_by_field_name("value")
        if held is None:
            return [(COMPUTED, choice)]
        if isinstance(value, Items) and isinstance(key, Number):
            index = int(key.value)
            inside = -len(value.items) <= index < len(value.items)
            return [(value.items[index] if inside else COMPUTED, choice)]
        if isinstance(value, Table):
            got = value.get(key)
            if got is not None:
                return [(got, choice)]
            if plain(key) is None:
                return self.any_item(value, (frame.id, _place_of_key(node)), choice)
        if isinstance(value, ArgumentsParsed):
            return (
                [(unpacked(value, (int(plain(key) or 0),)), choice)]
                if isinstance(key, Number)
                else [(COMPUTED, choice)]
            )
        if isinstance(value, Dotted) and value.path == "sys.argv":
            return [(argument_at(key), choice)]
        if value == COMMAND_LINE:
            return [(argument_at(key), choice)]
        stored = self.stored(key, held, frame, choice)
        if not stored and isinstance(value, Text) and is_whole_parameter(value) and not _sliced(node):
            return [(part_of_parameter(value, key if isinstance(key, Text) else COMPUTED), choice)]
        return stored or [(part_of(value), choice)]

    def any_item(self, value: Table, place: tuple[int, int], choice: Choice) -> Alternatives:
        """Return the values of a dictionary for a key that is not known, the same for every use of the key."""
        if place in choice:
            inside = choice[place] < len(value.items)
            return [(value.items[choice[place]][1] if inside else COMPUTED, choice)]
        listed = [(held, {**choice, place: index}) for index, (_, held) in enumerate(value.items[:_MAX_ROUNDS])]
        return [*listed] or [(COMPUTED, choice)]

    def stored(self, key: Thing, node: Node, frame: Frame, choice: Choice) -> Alternatives:
        """Return what `name[key] = value` stored before, in the same scope."""
        bindings = frame.scope.bindings.get(code(node) + "[]", ())
        found: Alternatives = []
        for binding in bindings:
            known = self.evaluate(binding.key, frame, choice)[0][0] if binding.key is not None else None
            if known is not None and plain(known) is not None and plain(known) == plain(key):
                found.extend(self.binding(binding, frame, choice))
        return found


def part_of(value: Thing) -> Thing:
    """Return what stands for an element of something that is not known, with the parameter that it comes from."""
    unset = isinstance(value, Text) and value.parameter is not None and HOLE in value.parts
    return value if unset or isinstance(value, Unknown) else COMPUTED


def _sliced(node: Node) -> bool:
    """Tell whether `value[key]` takes a slice, such as the rest of a text without its first letter."""
    key = node.child_by_field_name("subscript")
    return key is not None and key.type == "slice"


def unpacked(value: Thing, path: tuple[int, ...]) -> Thing:
    """Return the part of a value that unpacking takes."""
    for index in path:
        if isinstance(value, ArgumentsParsed):
            return value if index == 0 else COMPUTED
        if not isinstance(value, Items) or index >= len(value.items):
            return part_of(value)
        value = value.items[index]
    return value


def _held(call: Node) -> str:
    """Return the expression whose method is called."""
    called = call.child_by_field_name("function")
    return code(called.child_by_field_name("object")) if called is not None else ""


def _place_of_key(node: Node) -> int:
    """Return a number that stands for the key of `value[key]`: one for each name, else one for each place."""
    key = node.child_by_field_name("subscript")
    named = key is not None and key.type == "identifier"
    return -2 - sum(byte << 8 * index for index, byte in enumerate(code(key).encode())) if named else node.end_byte
