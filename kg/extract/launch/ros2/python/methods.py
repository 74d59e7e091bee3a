"""Methods of texts, lists, dictionaries, paths and open files."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

from kg.extract.launch.ros2.python.formatting import format_braces
from kg.extract.launch.ros2.python.machine import MAX_TEXT
from kg.extract.launch.ros2.python.operators import add, is_whole
from kg.extract.launch.ros2.python.paths import join_paths
from kg.extract.launch.ros2.python.texts import known, reason_of
from kg.extract.launch.ros2.python.values import Guarded, Items, LoadedFile, PathValue, Table, Unknown, Words

if TYPE_CHECKING:
    from kg.extract.launch.ros2.python.call import Call
    from kg.extract.launch.ros2.python.values import Value

__all__ = ["file_method", "list_method", "path_method", "table_method", "text_method"]

_TEXT: Final = frozenset(
    {
        "capitalize", "casefold", "endswith", "find", "index", "isdecimal", "isdigit", "isalpha", "isalnum", "isupper",
        "islower", "isspace", "lower", "lstrip", "partition", "removeprefix", "removesuffix", "replace", "rfind",
        "rpartition", "rsplit", "rstrip", "split", "splitlines", "startswith", "strip", "swapcase", "title", "upper",
        "count",
    }
)  # fmt: skip

_PRINTED: Final = frozenset({"toxml", "toprettyxml"})
"""Methods of what `xacro.process_file` gives; here that is its text already."""


def text_method(call: Call, receiver: str | Words, name: str) -> Value:
    """Return what a method of `str` gives."""
    if name == "join":
        return _join(call, receiver)
    if name in _PRINTED and isinstance(receiver, Words):
        return receiver
    text = known(receiver, call.machine.context)
    if text is None:
        return Unknown(reason_of(receiver))
    if name == "format":
        return format_braces(text, call.args, call.kwargs)
    arguments = [_plain(argument, call) for argument in call.args]
    if name not in _TEXT or call.kwargs or not all(is_whole(argument) for argument in arguments):
        return Unknown(next((reason_of(each) for each in arguments if not is_whole(each)), f"`str.{name}` is not read"))
    if name == "replace" and len(text) > MAX_TEXT // 100:
        return Unknown("a text is too long")
    try:
        found = getattr(text, name)(*arguments)
    except (ValueError, TypeError):
        return Unknown(f"`str.{name}` fails")
    return call.machine.items(found) if isinstance(found, list) else found


def _plain(argument: Value, call: Call) -> Value:
    text = known(argument, call.machine.context)
    return argument if text is None else text


def _join(call: Call, receiver: str | Words) -> Value:
    found = call.machine.iterate(call.value("iterable", 0))
    if found is None:
        return Unknown(reason_of(call.value("iterable", 0)))
    result: Value = ""
    for number, item in enumerate(found):
        call.machine.step()
        piece = Unknown(f"it depends on `{item.condition.written}`") if isinstance(item, Guarded) else item
        result = add(add(result, receiver) if number else result, piece)
    return result


def list_method(call: Call, receiver: Items, name: str) -> Value:
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
        return Unknown("there is nothing to take out of a list")
    elif name == "count":
        return sum(1 for item in receiver if is_whole(item) and item == value)
    elif name not in {"sort", "remove", "index", "discard"}:
        return Unknown(f"`list.{name}` is not read")
    return None


def table_method(call: Call, receiver: Table, name: str) -> Value:
    """Return what a method of `dict` gives; the dictionary may change."""
    key = call.value("key", 0)
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
        return receiver.copy() if name == "copy" else Unknown(f"`dict.{name}` is not read")
    if receiver.rest is not None:
        found.append(receiver.rest)
    return found


def _entry(call: Call, receiver: Table, name: str, key: Value) -> Value:
    default = call.value("default", 1)
    if not is_whole(key) or isinstance(key, Items):
        return Unknown(reason_of(key))
    if key in receiver:
        found = receiver[key]
        if name == "pop" and not call.machine.guards:
            del receiver[key]
        return found
    if receiver.rest is not None:
        return receiver.rest
    if name == "setdefault":
        call.machine.put(receiver, key, default, call.location)
    return default


def path_method(call: Call, receiver: PathValue, name: str) -> Value:
    """Return what a method of `pathlib.Path` gives."""
    machine = call.machine
    if name == "joinpath":
        return PathValue(join_paths([receiver, *call.args]))
    if name in {"as_posix", "__str__"}:
        return receiver.text
    if name in {"resolve", "absolute", "expanduser"}:
        return machine.normal_path(receiver)
    if name in {"exists", "is_file"}:
        return machine.exists(receiver)
    if name == "open":
        return call.again(machine.builtin("open"), [receiver])
    if name == "read_text":
        return file_method(call, call.again(machine.builtin("open"), [receiver]), "read")
    if name in {"with_suffix", "with_name"}:
        return _renamed(receiver, name, known(call.value("x", 0)))
    return Unknown(f"`Path.{name}` is not read")


def _renamed(receiver: PathValue, name: str, new: str | None) -> Value:
    text = known(receiver)
    if text is None or new is None:
        return Unknown(reason_of(receiver.text))
    folder, slash, last = text.rpartition("/")
    stem = last.rpartition(".")[0] or last
    return PathValue(folder + slash + (stem + new if name == "with_suffix" else new))


def file_method(call: Call, receiver: Value, name: str) -> Value:
    """Return what a method of an open file gives."""
    if not isinstance(receiver, LoadedFile):
        return Unknown(reason_of(receiver))
    if name == "read":
        return Unknown(receiver.reason) if receiver.text is None else receiver.text
    if name == "readlines" and receiver.text is not None:
        return call.machine.items(receiver.text.splitlines(keepends=True))
    return None if name == "close" else Unknown(receiver.reason or f"`{name}` of a file is not read")
