"""Methods of paths and open files."""

from __future__ import annotations

from typing import TYPE_CHECKING

from kg.extract.launch.expressions.texts import known, reason_of
from kg.extract.launch.expressions.values import Unknown
from kg.extract.launch.ros2.python.paths import join_paths
from kg.extract.launch.ros2.python.values import LoadedFile, PathValue

if TYPE_CHECKING:
    from kg.extract.launch.expressions.values import Value
    from kg.extract.launch.ros2.python.call import Call

__all__ = ["file_method", "path_method"]


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
