"""Copies of objects in C++: variables, parameters and elements hold objects of their own, pointers share them."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, Final, cast

from kg.extract.cpp.kinds import inside
from kg.symbolic import form
from kg.symbolic.kinds import is_pointer
from kg.symbolic.state import Frame
from kg.symbolic.values import Closure, Either, Kind, Mapping, Object, Sequence, TypeValue, Value

if TYPE_CHECKING:
    from kg.extract.cpp.language import Cpp
    from kg.symbolic.form import Expression, Type

_COPIED: Final = frozenset({Object, Either, Sequence, Mapping})
"""Values that are objects, or can have them."""
_PLACES: Final = frozenset({form.Name, form.Member, form.Index, form.Unary})
"""Expressions that mean an object in another place; all others return objects of their own."""
_AUTO: Final = ("auto",)
_THIS: Final = ("this",)
_ROWS: Final = frozenset({"pair", "tuple"})
_SHARED: Final = frozenset({"node", "handle", "carrier"})
"""Classes of frameworks whose copies stand for the same object, or that have no copies."""


class Copies:
    """The copies of the objects of a program."""

    def __init__(self, language: Cpp) -> None:
        self._language = language
        self._kinds = language.kinds

    def copy(self, value: Value, kind: Type | None, at: Frame, written: Expression, frame: Frame) -> Value:
        """Return the value that a place receives from an expression in a frame: a copy of an object in another place.

        `kind` is the type of the place, as the frame `at` means it; None if it is not declared.
        """
        if type(value) not in _COPIED or type(written) not in _PLACES:
            return value
        if isinstance(written, form.Unary) and written.sign != "*":
            return value
        if isinstance(written, form.Name) and written.names == _THIS:
            return value
        declared = self._kinds.variable_kind(kind, at) if kind is not None and kind.names != _AUTO else None
        return self.copied(value, declared or self._kind(written, frame))

    def assigned(self, target: Expression, value: Value, written: Expression, frame: Frame) -> Value:
        """Return the value that the target of an assignment holds after it.

        The object that a reference or `*pointer` means stays the same one, with the members of the other.
        """
        if type(value) not in _COPIED:
            return value
        declared = self._kinds.written_type(target, frame) if isinstance(target, (form.Name, form.Member)) else None
        kind, at = declared or (None, frame)
        value = self.copy(value, kind, at, written, frame)
        through = kind.reference if kind is not None else isinstance(target, form.Unary)
        current = self._language.machine.value(target, frame) if through and isinstance(value, Object) else None
        if not (isinstance(current, Object) and isinstance(value, Object) and current.kind.cls is value.kind.cls):
            return value
        for name, member in value.fields.items() if current.kind.cls is not None else ():
            self._language.machine.write(current.fields, name, member)
        return current if current.kind.cls is not None else value

    def closure(self, expression: form.Lambda, frame: Frame) -> Value:
        """Return the function of a lambda, with the variables that it copies in a frame of their own."""
        shared = expression.shared
        if not expression.captures and shared is None:
            return Closure(expression.function, frame)
        inner = Frame(frame.unit, frame.scope, frame.this, parent=frame)
        names = [name for name in frame.variables if name not in shared] if shared is not None else ()
        around = [(name, form.Name(expression.line, (name,))) for name in names]
        for name, written in (*around, *expression.captures):
            inner.variables[name] = self.copy(self._language.machine.value(written, frame), None, frame, written, frame)
        captured = tuple(cast("Value", inner.variables[name]) for name, _ in expression.captures)
        return Closure(expression.function, inner, captured=captured)

    def _kind(self, written: Expression, frame: Frame) -> Kind | None:
        """Return the type of an expression, with pointers; None if it is not declared."""
        if isinstance(written, form.Index):
            of = self._kind(written.of, frame)
            inner = of.arguments[-1] if of is not None and of.arguments else None
            return inner.kind if isinstance(inner, TypeValue) else None
        declared = self._kinds.written_type(written, frame) if isinstance(written, (form.Name, form.Member)) else None
        if declared is None or (declared[0].names == _AUTO and not declared[0].pointer):
            return None
        return self._kinds.variable_kind(*declared)

    def copied(self, value: Value, kind: Kind | None = None, copies: dict[int, Object] | None = None) -> Value:
        """Return a copy of a value of a type; objects that pointers hold are the same in both.

        Without a type, objects that `new` or `make_shared` made count as held by pointers. `copies` are those of the
        objects around it, which can hold each other where alternatives were joined.
        """
        copies = {} if copies is None else copies
        if isinstance(value, Object):
            pointer = is_pointer(kind) if kind is not None else value.heap
            described = self._language.machine.framework.described(value.kind) if not pointer else []
            shared = pointer or any(one.is_a in _SHARED for one in described)
            return value if shared else self._object(value, copies)
        if isinstance(value, Either):
            return replace(value, items=tuple(self.copied(item, kind, copies) for item in value.items))
        inner = kind.arguments[-1] if kind is not None and kind.arguments and kind.name not in _ROWS else None
        of = inner.kind if isinstance(inner, TypeValue) else None
        if isinstance(value, Sequence) and any(isinstance(item, (Object, Sequence, Either)) for item in value.items):
            return replace(value, items=tuple(self.copied(item, of, copies) for item in value.items))
        if isinstance(value, Mapping) and any(isinstance(item, (Object, Sequence, Either)) for _, item in value.items):
            return replace(value, items=tuple((key, self.copied(item, of, copies)) for key, item in value.items))
        return value

    def _object(self, of: Object, copies: dict[int, Object]) -> Object:
        """Return a copy of an object, with copies of the members that it holds itself."""
        if id(of) in copies:
            return copies[id(of)]
        copy = copies[id(of)] = replace(of, fields=dict(of.fields), native=dict(of.native), heap=False)
        classes = self._kinds.chain(of.kind)[0]
        for name, value in of.fields.items():
            if not isinstance(value, (Object, Sequence, Mapping, Either)):
                continue
            cls, bound = next(((cls, bound) for cls, bound in classes if name in cls.fields), (None, {}))
            kind = cls.fields[name].type if cls is not None else None
            if cls is None or kind is None:
                copy.fields[name] = self.copied(value, None, copies)
            elif not (kind.pointer or kind.reference):
                copy.fields[name] = self.copied(value, self._kinds.variable_kind(kind, inside(cls, bound)), copies)
        return self._language.machine.created(copy)
