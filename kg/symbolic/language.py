"""The interface that the interpreter needs of a language: what names, members, calls and types mean."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Protocol

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping

    from kg.symbolic import form
    from kg.symbolic.form import Class, Expression, Function, Type
    from kg.symbolic.state import Frame
    from kg.symbolic.values import Kind, Value


class Language(Protocol):
    """A language of the sources."""

    @property
    def expressions(self) -> Mapping[type, Callable[[Any, Frame], Value]]:
        """How expressions run that only this language has, by their class."""

    @property
    def statements(self) -> Mapping[type, Callable[[Any, Frame], str | None]]:
        """How statements run that only this language has, by their class."""

    # Names and members

    def name(self, expression: form.Name, frame: Frame) -> Value:
        """Return the value of a name that is not a local variable."""

    def member(self, of: Value, name: str) -> Value:
        """Return a member of a value."""

    def assign_name(self, target: form.Name, value: Value, frame: Frame) -> None:
        """Set a variable that is not local to the function."""

    def static_member(self, kind: Kind, name: str) -> Value | None:
        """Return a static member of a class; None if it has no such member."""

    def static_fields(self, of: Value) -> dict[str, Value] | None:
        """Return the variables of a class, for writing; None if they are not written so."""

    # Types

    def kind(self, kind: Type, frame: Frame) -> Kind | Value:
        """Return the meaning of a type in a frame: a `Kind`, or the value of a template parameter."""

    def kind_of(self, kind: Type | None, frame: Frame) -> Kind | None:
        """Return the type of a declaration, without pointers; None if it has no type."""

    def type_of(self, expression: Expression, frame: Frame) -> Kind | None:
        """Return the declared type of a variable or member."""

    def message(self, kind: Kind, frame: Frame | None) -> Kind:
        """Return the message that objects of a type are sent as, where a frame uses it: the type itself if none."""

    def nested_type(self, kind: Kind, name: str) -> Kind | None:
        """Return a type that a class defines as an alias; None if it has no such alias."""

    def chain(self, kind: Kind) -> tuple[list[tuple[Class, dict[str, Value]]], list[Kind]]:
        """Return the classes of an object in the sources, with their template arguments, and its bases outside."""

    def methods(self, kind: Kind, name: str) -> list[tuple[Function, dict[str, Value]]]:
        """Return the methods of a class by name, those of the class before those of its bases."""

    def declarations(self, kind: Kind, name: str) -> list[tuple[Function, dict[str, Value]]]:
        """Return the methods of a class by name, or their declarations if none has a body."""

    def reaches(self, function: Function) -> bool:
        """Check whether a run of a function can have an effect, as far as its code shows."""

    def spares(self, function: Function, this: Value | None, arguments: list[Value]) -> bool:
        """Check whether a call in a callback need not run; if so, make unknown what it changes."""

    # Values

    def default(self, kind: Type, frame: Frame, line: int) -> Value:
        """Return the value of a variable that is declared without one."""

    def unknown(self, kind: Type | None, frame: Frame, name: str) -> Value:
        """Return a value of a type that comes from outside."""

    def converted(self, value: Value, kind: Type | None, written: Expression | None, frame: Frame) -> Value:
        """Return a value as a variable of a type holds it."""

    def assigned(self, target: Expression, value: Value, written: Expression, frame: Frame) -> Value:
        """Return a value as the target of an assignment holds it."""

    # Operators

    def elements(self, of: Value) -> list[Value]:
        """Return the elements of a container, or one that represents all of them."""

    def element(self, of: Value, key: Value) -> Value:
        """Return the element of a container at a key."""

    def with_element(self, of: Value, key: Value, value: Value) -> Value:
        """Return a container with an element replaced."""

    def counted(self, loop: form.Loop) -> list[Expression]:
        """Return the variables that a loop increments."""

    def formatted(self, row: tuple[Value, ...]) -> Value:
        """Return the text of `format % value`."""

    def shifted(self, values: list[Value]) -> Value | None:
        """Return the stream that `<<` writes to; None if `<<` shifts bits."""

    # Calls

    def call(self, expression: form.Call, frame: Frame) -> Value:
        """Run a call and return its value."""

    def construct_expression(self, expression: form.Construct, frame: Frame) -> Value:
        """Return the object that a construction makes."""

    def create(self, value: Value) -> None:
        """Create an object of a class, as code outside the sources does."""

    def escape(self, values: list[Value]) -> None:
        """Schedule functions that are passed to code outside the sources."""
