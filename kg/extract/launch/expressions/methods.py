"""Methods of texts, lists, tuples and dictionaries."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Final

from kg.extract.launch.expressions.formatting import format_braces
from kg.extract.launch.expressions.functions import settled
from kg.extract.launch.expressions.joining import concatenate
from kg.extract.launch.expressions.texts import known, reason_of
from kg.extract.launch.expressions.values import Guarded, Items, Table, Unknown, Words
from kg.extract.launch.expressions.whole import (
    MAX_TEXT,
    ExpressionError,
    UnsupportedError,
    apply,
    is_whole,
    refuse_over,
)

if TYPE_CHECKING:
    from kg.extract.launch.expressions.call import Call
    from kg.extract.launch.expressions.values import Value

__all__ = ["method"]

_TEXT: Final = frozenset(
    {
        "capitalize", "casefold", "count", "endswith", "find", "index", "isalnum", "isalpha", "isascii", "isdecimal",
        "isdigit", "isidentifier", "islower", "isnumeric", "isspace", "istitle", "isupper", "lower", "lstrip",
        "partition", "removeprefix", "removesuffix", "replace", "rfind", "rindex", "rpartition", "rsplit", "rstrip",
        "split", "splitlines", "startswith", "strip", "swapcase", "title", "upper",
    }
)  # fmt: skip
_PADDED: Final = frozenset({"center", "ljust", "rjust", "zfill"})
_MOST_PADDED: Final = 1_000


def method(call: Call, receiver: str | Words | Items | tuple[Value, ...] | Table, name: str) -> Value:
    """Return what a method gives; a list or dictionary may change."""
    if isinstance(receiver, str | Words):
        return _text_method(call, receiver, name)
    if isinstance(receiver, Table):
        return _table_method(call, receiver, name)
    if name in {"count", "index"}:
        return _position(call, receiver, name)
    return _list_method(call, receiver, name) if isinstance(receiver, Items) else _missing("tuple", name)


def _missing(kind: str, name: str) -> Value:
    raise UnsupportedError(f"`{kind}.{name}` is not read")


def _text_method(call: Call, receiver: str | Words, name: str) -> Value:
    """Return what a method of `str` gives."""
    if name == "join":
        return _join(call, receiver)
    text = known(receiver, call.machine.context)
    if text is None:
        return Unknown(reason_of(receiver))
    if name == "format":
        return format_braces(text, call.args, call.kwargs)
    args = [settled(call, value) for value in call.args]
    kwargs = {key: settled(call, value) for key, value in call.kwargs.items()}
    for value in (*args, *kwargs.values()):
        if not is_whole(value):
            return Unknown(reason_of(value))
    if name in _PADDED and args and isinstance(args[0], int):
        refuse_over(args[0], _MOST_PADDED)
    elif name == "replace":
        _bound_replacement(text, *args[:2])
    elif name not in _TEXT:
        _missing("str", name)
    return call.machine.weigh(apply(getattr(text, name), args, kwargs, tuple(call.machine.guards)))


def _bound_replacement(text: str, old: Any = None, new: Any = None) -> None:
    if isinstance(old, str) and isinstance(new, str):
        refuse_over(len(text) + text.count(old) * len(new), MAX_TEXT)


def _join(call: Call, receiver: str | Words) -> Value:
    value = call.value("iterable", 0)
    found = call.machine.iterate(value)
    if found is None:
        return Unknown(reason_of(value))
    texts = [item for item in found if isinstance(item, str)]
    if isinstance(receiver, str) and len(texts) == len(found):
        refuse_over(sum(map(len, texts)) + len(receiver) * len(texts))
        return call.machine.weigh(receiver.join(texts))
    result: Value = ""
    for number, item in enumerate(found):
        call.machine.step()
        if is_whole(item) and not isinstance(item, str):
            raise ExpressionError(f"TypeError: sequence item {number}: expected str, {type(item).__name__} found")
        piece = Unknown(f"it depends on `{item.condition.written}`") if isinstance(item, Guarded) else item
        result = concatenate(concatenate(result, receiver) if number else result, piece)
    return result


def _position(call: Call, receiver: Items | tuple[Value, ...], name: str) -> Value:
    """Return `count` or `index` of an item."""
    args = [receiver, *(settled(call, value) for value in call.args)]
    if not all(is_whole(value) for value in args):
        return Unknown(next(reason_of(value) for value in args if not is_whole(value)))
    return apply(getattr(tuple, name), [tuple(receiver), *args[1:]])


def _list_method(call: Call, receiver: Items, name: str) -> Value:
    """Return what a method of `list` (or of a set, which is read as one) gives; the list may change."""
    machine, value = call.machine, call.value("x", 0)
    machine.keep(receiver)
    if name in {"append", "add"}:
        machine.append(receiver, [value])
    elif name in {"extend", "update"}:
        found = machine.iterate(value)
        machine.append(receiver, [value] if found is None else found)
    elif name == "insert" and len(call.args) > 1 and isinstance(value, int):
        receiver.insert(value, machine.guarded(call.args[1], receiver.guards))
    elif name == "copy":
        return machine.items(receiver)
    elif name == "clear" and not machine.guards:
        receiver.clear()
    elif name == "reverse":
        receiver.reverse()
    elif name == "pop" and not machine.guards and (value is None or isinstance(value, int)):
        at = -1 if value is None else value
        if -len(receiver) <= at < len(receiver):
            return receiver.pop(at)
        raise ExpressionError("IndexError: there is nothing to take out of a list")
    elif name == "sort" and is_whole(receiver) and not call.args and not machine.guards:
        ordered = apply(sorted, [receiver], call.kwargs)
        receiver[:] = ordered if isinstance(ordered, Items) else receiver
    elif name not in {"sort", "remove", "discard"}:
        return _missing("list", name)
    return None


def _table_method(call: Call, receiver: Table, name: str) -> Value:
    """Return what a method of `dict` gives; the dictionary may change."""
    key = settled(call, call.value("key", 0))
    call.machine.keep(receiver)
    if name == "update":
        for other in call.args:
            call.machine.spread_table(receiver, other)
        for keyword, value in call.kwargs.items():
            call.machine.put(receiver, keyword, value, call.place(keyword))
        return None
    if name in {"get", "pop", "setdefault"}:
        return _entry(call, receiver, name, key)
    if name in {"items", "keys", "values"} and receiver.rest is not None and not receiver:
        return receiver.rest
    if name == "items":
        found = call.machine.items((entry, value) for entry, value in receiver.items())
    elif name == "keys":
        found = call.machine.items(receiver)
    elif name == "values":
        found = call.machine.items(receiver.values())
    else:
        return receiver.copy() if name == "copy" else _missing("dict", name)
    if receiver.rest is not None:
        found.append(receiver.rest)
    return found


def _entry(call: Call, receiver: Table, name: str, key: Value) -> Value:
    default = call.value("default", 1)
    if not is_whole(key):
        return Unknown(reason_of(key))
    if isinstance(key, Items | Table):
        raise ExpressionError(f"TypeError: a {type(key).__name__.lower()} cannot be a key")
    if key in receiver:
        found = receiver[key]
        if name == "pop" and not call.machine.guards:
            del receiver[key]
        return found
    if receiver.rest is not None:
        return receiver.rest
    if name == "setdefault":
        call.machine.put(receiver, key, default, call.location)
    elif name == "pop" and len(call.args) == 1:
        raise ExpressionError(f"KeyError: {key!r}")
    return default
