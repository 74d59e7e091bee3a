"""Functions of Python's modules and of ament that launch files use: paths, the environment, YAML and JSON."""

from __future__ import annotations

import copy
import json
from typing import TYPE_CHECKING, Final

from kg.extract.launch.expressions.texts import known, reason_of, simplify, to_text
from kg.extract.launch.expressions.values import Items, Substitution, Table, Unknown, Words
from kg.extract.launch.expressions.whole import MAX_TEXT, is_whole
from kg.extract.launch.ros2.python import paths
from kg.extract.launch.ros2.python.documents import construct, read_yaml
from kg.extract.launch.ros2.python.values import Description, Instance, Klass, LoadedFile, PathValue

if TYPE_CHECKING:
    from collections.abc import Callable

    from kg.extract.launch.expressions.values import Value
    from kg.extract.launch.ros2.python.call import Call

__all__ = ["SYSTEM"]


def _join(call: Call) -> Value:
    return paths.join_paths(call.args)


def _path(call: Call) -> Value:
    return PathValue(paths.join_paths(call.args))


def _own_path(value: Value) -> str | Words:
    return simplify(to_text(value))


def _share(call: Call) -> Value:
    name = known(call.value("package_name", 0), call.machine.context)
    if name is None:
        return Words((Substitution("find-pkg-share", (to_text(call.value("package_name", 0)),)),))
    return f"package://{name}"


def _share_path(call: Call) -> Value:
    return PathValue(_own_path(_share(call)))


def _prefix(call: Call) -> Value:
    return Words((Substitution("find-pkg-prefix", (to_text(call.value("package_name", 0)),)),))


def _variable(call: Call) -> Value:
    name, default = call.value("key", 0), call.value("default", 1)
    if default is None or not isinstance(default, str | Words):
        return Words((Substitution("env", (to_text(name),)),))
    return Words((Substitution("env", (to_text(name), to_text(default))),))


def _data(call: Call, name: str) -> LoadedFile | Unknown:
    value = call.value(name, 0)
    if isinstance(value, LoadedFile):
        return value if value.text is not None else Unknown(value.reason)
    text = known(value, call.machine.context)
    return LoadedFile(text) if text is not None else Unknown(reason_of(value))


def _yaml(call: Call) -> Value:
    data = _data(call, "stream")
    if isinstance(data, Unknown):
        return data
    machine = call.machine
    file = data.file
    return read_yaml(machine, data.text or "", lambda line: machine.at(file, line) if file else call.location)


def _json(call: Call) -> Value:
    data = _data(call, "s")
    if isinstance(data, Unknown):
        return data
    try:
        return construct(call.machine, json.loads(data.text or ""))
    except (ValueError, RecursionError):
        return Unknown("a JSON text is not valid")


def _exists(call: Call) -> Value:
    return call.machine.exists(call.value("path", 0))


def _extension(call: Call) -> Value:
    text = known(call.value("p", 0), call.machine.context)
    if text is None:
        return Unknown(reason_of(call.value("p", 0)))
    head, dot, tail = text.rpartition(".")
    return (head, dot + tail) if dot and "/" not in tail else (text, "")


def _copy(call: Call) -> Value:
    value = call.value("x", 0)
    if isinstance(value, Table):
        return value.copy()
    if isinstance(value, Description):
        return Description(call.machine.items(value.entities))
    return call.machine.items(value) if isinstance(value, Items) else value


def _deep_copy(call: Call) -> Value:
    value = call.value("x", 0)
    return copy.deepcopy(value) if isinstance(value, Table | Items) else value


def _default_table(call: Call) -> Value:
    table = call.machine.table()
    table.factory = call.value("default_factory", 0)
    return table


def _described(call: Call) -> Value:
    """Return the text that xacro prints of a file: `xacro.process_file(path, mappings={...})`."""
    words: list[str | Substitution] = ["xacro ", *to_text(call.value("input_file_name", 0))]
    mappings = call.value("mappings")
    for name, value in mappings.items() if isinstance(mappings, Table) else ():
        words += [f" {name}:=", *to_text(value)]
    return Words((Substitution("command", (tuple(words),)),), lazy=True)


def _is_instance(call: Call) -> Value:
    value, kind = call.value("obj", 0), call.value("class_or_tuple", 1)
    if isinstance(value, Instance) and isinstance(kind, Klass):
        return value.klass is kind or kind in value.klass.bases
    names = {"builtins.str": str, "builtins.bool": bool, "builtins.int": int, "builtins.float": float}
    names |= {"builtins.list": Items, "builtins.dict": Table, "builtins.tuple": tuple}
    expected = names.get(getattr(kind, "path", ""))
    if expected is None or not (is_whole(value) or isinstance(value, Items | Table | tuple)):
        return Unknown("the type of a value is not known")
    return isinstance(value, expected)


def _attribute(call: Call) -> Value:
    name = known(call.value("name", 1))
    if name is None:
        return Unknown("the name of an attribute is not known")
    found = call.machine.attribute(call.value("object", 0), name)
    return call.args[2] if isinstance(found, Unknown) and len(call.args) > 2 else found  # noqa: PLR2004 - a default


def _open(call: Call) -> Value:
    path = call.value("file", 0)
    text = known(path, call.machine.context)
    file = call.machine.find_file(text) if text is not None else None
    data = call.machine.files.read(file) if file is not None else None
    if data is None:
        why = reason_of(path) if text is None else f"the file {text} is not in the build"
        return LoadedFile(None, file, why)
    return LoadedFile(data.decode("utf-8", "replace")[:MAX_TEXT], file)


SYSTEM: Final[dict[str, Callable[[Call], Value]]] = {
    "xacro.process_file": _described,
    "os.path.join": _join,
    "os.path.dirname": lambda call: paths.parent(_own_path(call.value("p", 0))),
    "os.path.basename": lambda call: paths.base(_own_path(call.value("p", 0))),
    "os.path.abspath": lambda call: call.machine.normal_path(_own_path(call.value("path", 0))),
    "os.path.realpath": lambda call: call.machine.normal_path(_own_path(call.value("path", 0))),
    "os.path.normpath": lambda call: call.machine.normal_path(_own_path(call.value("path", 0))),
    "os.path.expanduser": lambda call: call.value("path", 0),
    "os.path.splitext": _extension,
    "os.path.exists": _exists,
    "os.path.isfile": _exists,
    "os.getenv": _variable,
    "os.environ.get": _variable,
    "os.fspath": lambda call: _own_path(call.value("path", 0)),
    "pathlib.Path": _path,
    "pathlib.PurePath": _path,
    "pathlib.PosixPath": _path,
    "get_package_share_directory": _share,
    "get_package_share_path": _share_path,
    "get_package_prefix": _prefix,
    "yaml.safe_load": _yaml,
    "yaml.load": _yaml,
    "yaml.full_load": _yaml,
    "json.load": _json,
    "json.loads": _json,
    "copy.copy": _copy,
    "copy.deepcopy": _deep_copy,
    "collections.defaultdict": _default_table,
    "builtins.isinstance": _is_instance,
    "builtins.getattr": _attribute,
    "builtins.open": _open,
    "builtins.print": lambda _: None,
}
