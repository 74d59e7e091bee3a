"""Specialisations of templates in C++: which class or function some template arguments choose."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING, Final, TypeAlias, TypeVar

from kg.extract.cpp import library
from kg.symbolic import form
from kg.symbolic.kinds import POINTER
from kg.symbolic.state import Frame
from kg.symbolic.values import Enumerator, Kind, Number, Pack, Text, Truth, TypeValue, Unknown, Value

if TYPE_CHECKING:
    from collections.abc import Iterable

    from kg.extract.cpp.kinds import Kinds
    from kg.symbolic.form import Class, Expression, Function, Type

_Item = TypeVar("_Item")
_Template = TypeVar("_Template", "Class", "Function")
_Scope: TypeAlias = tuple[str, ...]
_Pattern: TypeAlias = "tuple[Type | Expression, ...]"
_Bound = dict[str, Value]
UNKNOWN: Final = Unknown("it depends on a template argument")
"""What depends on a specialisation that is not known."""
_PLAIN: Final = library.NUMBERS | library.TEXTS | {"bool", "char", "void", POINTER}
_SCOPES: Final = re.compile(r"\w+::")
_COMPUTING: Final = ("enable_if", "void_t", "conditional")
"""How the names of templates begin whose result depends on conditions."""
_DEEPEST: Final = 8


def choose(
    kinds: Kinds, items: Iterable[tuple[_Item, _Pattern, _Scope, Frame]], arguments: tuple[Value, ...]
) -> tuple[_Item, _Bound] | Unknown | None:
    """Return the most special of some specialisations that template arguments choose, and its own parameters.

    Each is given with the arguments that it is for, its own parameters, and the frame of both. The result is None if
    none matches, and unknown if that depends on an argument that is not known.
    """
    best: tuple[int, _Item, _Bound] | None = None
    unknown = -1
    for item, pattern, names, at in items:
        match = _Match(kinds, names, at)
        with kinds.choosing() as possible:
            fits = match.all(pattern, arguments) if possible else None
        weight = sum(_weight(one, names) for one in pattern)
        if fits is None:
            unknown = max(unknown, weight)
        elif fits and (best is None or weight > best[0]):
            best = (weight, item, match.bound)
    if unknown >= 0 and (best is None or unknown > best[0]):
        return UNKNOWN
    return best[1:] if best is not None else None


def _weight(pattern: Type | Expression, names: tuple[str, ...]) -> int:
    """Return how much of an argument a pattern fixes: the parts that are no parameters of the specialisation."""
    if not isinstance(pattern, form.Type):
        return 1
    inner = sum(_weight(one, names) for one in (*pattern.arguments, *pattern.outer))
    own = pattern.pointer + pattern.reference + pattern.constant
    return inner + own + (len(pattern.names) != 1 or pattern.names[0] not in names)


class _Match:
    """The comparison of template arguments with what a specialisation is for; each result None if it is not known."""

    def __init__(self, kinds: Kinds, names: _Scope, at: Frame) -> None:
        self._kinds, self._names, self._at = kinds, names, at
        self.bound: _Bound = {}
        """The values of the parameters of the specialisation."""

    def all(self, pattern: _Pattern, arguments: tuple[Value, ...], depth: int = 0) -> bool | None:
        """Return whether all arguments match."""
        result: bool | None = True
        variadic = any(isinstance(one, form.Spread | form.Name) and _parameter(one, self._names) for one in pattern)
        for place, one in enumerate(pattern):
            if isinstance(one, form.Spread | form.Name) and (last := _parameter(one, self._names)) is not None:
                self.bound[last] = Pack(arguments[place:])
                return result
            missing = False if variadic else None  # a default may be in a declaration
            fits = self._one(one, arguments[place], depth) if place < len(arguments) else missing
            if fits is False:
                return False
            result = result if fits else None
        return result if len(arguments) <= len(pattern) else False

    def _one(self, pattern: Type | Expression, given: Value, depth: int) -> bool | None:
        names = self._names
        if not isinstance(pattern, form.Type) or depth > _DEEPEST or not mentions(pattern, names):
            fixed = self._kinds.template((pattern,), self._at)
            return alike(fixed[0], given) if len(fixed) == 1 else None
        if pattern.reference or pattern.constant:  # which values of types do not record
            return False
        kind = given.kind if isinstance(given, TypeValue) else None
        if pattern.pointer:
            inner = next(iter(kind.arguments), None) if kind is not None and kind.names == (POINTER,) else None
            if inner is None:
                return None if kind is None or is_open(kind) else False
            return self._one(form.Type(pattern.names, pattern.arguments, pattern.outer), inner, depth + 1)
        if len(pattern.names) == 1 and pattern.names[0] in names:
            previous = self.bound.setdefault(pattern.names[0], given)
            return previous is given or alike(previous, given)
        if pattern.outer or kind is None or is_open(kind) or pattern.names[0] in names:
            return None  # `typename T::type`, which has to be computed
        head = self._kinds.kind(form.Type(pattern.names), self._at)
        same = _same(Kind(head.names, (), head.cls), Kind(kind.names, (), kind.cls)) if isinstance(head, Kind) else None
        if not same:
            return None if pattern.names[-1].startswith(_COMPUTING) else same
        return self.all(pattern.arguments, kind.arguments, depth + 1)


def _parameter(expression: Expression, names: _Scope) -> str | None:
    """Return the parameter that an expression among patterns names, which is a pack."""
    inner = expression.of if isinstance(expression, form.Spread) else expression
    listed = inner.names if isinstance(inner, form.Name | form.Type) else ()
    return listed[0] if len(listed) == 1 and listed[0] in names else None


def mentions(kind: Type, names: tuple[str, ...]) -> bool:
    """Return whether a type mentions a template parameter."""
    listed = (*kind.arguments, *kind.outer)
    return any(name in names for name in kind.names[:1]) or any(
        mentions(one, names) if isinstance(one, form.Type) else _parameter(one, names) is not None for one in listed
    )


def is_open(kind: Kind) -> bool:
    """Return whether a type can be a parameter of a template without a known argument: nothing defines its name."""
    return kind.cls is None and len(kind.names) == 1 and kind.name not in _PLAIN


def alike(one: Value, other: Value) -> bool | None:
    """Return whether two template arguments are the same; None if that is not known."""
    if isinstance(one, TypeValue) and isinstance(other, TypeValue):
        return _same(one.kind, other.kind)
    if isinstance(one, Number) and isinstance(other, Number):
        return one.value == other.value
    for kind in (Truth, Enumerator, Text):
        if isinstance(one, kind) and isinstance(other, kind):
            return one == other
    return None


def _same(one: Kind, other: Kind) -> bool | None:
    """Return whether two types are the same; the names of those outside of the sources can lack their first parts."""
    if one.cls is not None and other.cls is not None:
        result: bool | None = one.cls is other.cls
    else:
        length = min(len(one.names), len(other.names))
        result = one.names[-length:] == other.names[-length:] or (None if is_open(one) or is_open(other) else False)
    if not result:
        return result
    for first, second in zip(one.arguments, other.arguments, strict=False):
        same = alike(first, second)
        if same is False:
            return False
        result = result if same else None
    return result


def chosen_functions(kinds: Kinds, functions: list[Function], arguments: tuple[Value, ...]) -> list[Function]:
    """Return those of some functions that template arguments choose: a specialisation, or the general ones.

    Arguments that are deduced choose none here, as the parameters of the functions differ.
    """
    special = [one for one in functions if one.pattern] if arguments else []
    if not special:
        return functions
    found = choose(kinds, (_written(one, one.pattern) for one in special), arguments)
    return [one for one in functions if one not in special] if found is None else _only(found)


def chosen_methods(kinds: Kinds, methods: list[Function], arguments: tuple[Value, ...]) -> list[Function]:
    """Return those of some methods that the template arguments of their class choose.

    One that has no other definition is chosen, whatever is known.
    """
    special = [one for one in methods if one.within]
    if not special or len(methods) == 1:
        return methods
    found = choose(kinds, (_written(one, one.within) for one in special), arguments)
    return [one for one in methods if one not in special] if found is None else _only(found)


def chosen_class(
    kinds: Kinds, general: Class | None, classes: list[Class], arguments: tuple[Value, ...]
) -> tuple[Class, _Bound] | Unknown | None:
    """Return the one of some specialisations of a class that template arguments choose, as `choose` does.

    Arguments that a specialisation leaves out are the defaults of the `general` class.
    """

    def whole(one: Class) -> _Pattern:
        rest = general.template[len(one.pattern) :] if general is not None else ()
        return (*one.pattern, *(general.defaults[name] for name in rest if general and name in general.defaults))

    return choose(kinds, (_written(one, whole(one)) for one in classes), arguments)


def _written(item: _Template, pattern: _Pattern) -> tuple[_Template, _Pattern, _Scope, Frame]:
    return item, pattern, item.template, Frame(item.unit, item.scope)


def _only(found: tuple[Function, _Bound] | Unknown) -> list[Function]:
    return [] if isinstance(found, Unknown) else [found[0]]


def same_text(one: str, other: str) -> bool:
    """Return whether two spellings of template arguments agree but for their scopes."""
    return one == other or _SCOPES.sub("", one) == _SCOPES.sub("", other)
