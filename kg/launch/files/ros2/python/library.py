"""The functions and classes that launch files use, by name: of launch and ament, of files, YAML and the environment.

A call of a class of launch becomes an object, whose meaning is read when the launch description is complete.
"""

from __future__ import annotations

import posixpath
from dataclasses import replace
from fnmatch import fnmatch
from typing import TYPE_CHECKING, Final

import yaml

from kg.extract.python import library as python
from kg.extract.python.evaluation import Dialect, ExpressionError, UnknownValueError, UnsupportedError, evaluate_text
from kg.extract.python.paths import joined
from kg.launch.files.ros2.context import HOLE
from kg.launch.files.ros2.python.entities import ENTITIES
from kg.launch.files.ros2.python.values import (
    CONDITIONS,
    PLAIN,
    SUBSTITUTIONS,
    Instance,
    Later,
    condition,
    guarded,
    is_substitution,
    later,
    launch_text,
    reason_of,
    text_of,
)
from kg.symbolic.operators import NULL, plain
from kg.symbolic.state import Arguments
from kg.symbolic.values import Kind, Mapping, Number, Sequence, Text, Truth, Unknown, Value, as_text
from kg.yamltext import compose_yaml

if TYPE_CHECKING:
    from collections.abc import Callable
    from collections.abc import Mapping as Names

    from kg.corpus.files import FilePath
    from kg.launch.files.ros2.python.language import LaunchPython
    from kg.launch.files.ros2.python.machine import LaunchMachine


def read_yaml(machine: LaunchMachine, text: str, file: FilePath | None) -> Value:
    """Return what `yaml.safe_load` or `json.load` gives, within bounds; keys remember their lines of the file."""
    try:
        node = compose_yaml(text)
        return _value(machine, node, file, yaml.SafeLoader("")) if node is not None else NULL
    except (yaml.YAMLError, ValueError, RecursionError):
        return Unknown("a YAML or JSON text is not valid")


def _value(machine: LaunchMachine, node: yaml.Node, file: FilePath | None, loader: yaml.SafeLoader) -> Value:
    machine.step()
    if isinstance(node, yaml.MappingNode):
        entries: dict[Value, tuple[Value, Value]] = {}
        for key_node, value_node in node.value:
            key = _value(machine, key_node, file, loader)
            if isinstance(key, Text | Number | Truth):
                if file is not None:
                    machine.place(key, file, key_node.start_mark.line + 1)
                entries[key] = key, _value(machine, value_node, file, loader)
        return Mapping(tuple(entries.values()))
    if isinstance(node, yaml.SequenceNode):
        return Sequence(tuple(_value(machine, each, file, loader) for each in node.value))
    constructed: object = loader.construct_object(node)
    value = constructed if constructed is None or isinstance(constructed, str | bool | int | float) else node.value
    machine.step()
    if isinstance(value, bool):
        return Truth(value)
    if isinstance(value, int | float):
        return Number(value, repr(value))
    return NULL if value is None else Text.of(str(value))


CONFIGURATIONS: Final = "launch_configurations"
_FILE: Final = "<file>"
_MOST_TEXT: Final = 200_000
_CLASSES: Final[Names[str, tuple[str, ...]]] = {
    **{name: names[1:] for name, names in PLAIN.items()},
    **{name: names for name, (names, _) in SUBSTITUTIONS.items()},
    **CONDITIONS,
    **{name: names for name, (names, _) in ENTITIES.items()},
    "LaunchContext": (),
    "LaunchLogDir": (),
    "LaunchConfigurationContext": (),
    "ParameterValue": ("value",),
    "Parameter": ("name", "value"),
}
"""Classes, and functions that make actions: the names of their parameters in order."""
EXTENDED: Final = frozenset({*_CLASSES, "Action", "OpaqueCoroutine", "Substitution"})
"""Classes that others may extend."""


# Calls


def call(language: LaunchPython, kind: Kind, given: Arguments) -> Value | None:
    """Return the result of a function or class outside of the build; None for others."""
    path, name = ".".join(kind.names), kind.name
    outside = path if kind.names[0] == "builtins" else name
    of_one = _OF_ONE.get(path) or _OF_ONE.get(outside)
    if of_one is not None:
        fields = _bound(("context",) if name in _WITH_CONTEXT else (), given)
        fields.pop("context", None)
        return language.machine.over((_first(fields),), lambda value: of_one(language, value))
    apply = _FUNCTIONS.get(path) or _FUNCTIONS.get(outside)
    if apply is not None:
        fields = _bound((), given)
        return language.machine.over(
            fields.values(), lambda *row: apply(language, dict(zip(fields, row, strict=True)), given)
        )
    if name in _CLASSES and kind.names[0] != "builtins":
        return create(language, name, _bound(_CLASSES[name], given), given)
    return python.call(language, kind.names, given)


def _bound(names: tuple[str, ...], given: Arguments) -> dict[str, Value]:
    fields = dict(zip(names, given.values, strict=False))
    fields.update({f"*{index}": value for index, value in enumerate(given.values[len(names) :])})
    return {**fields, **given.named}


def create(language: LaunchPython, name: str, fields: dict[str, Value], given: Arguments | None = None) -> Instance:
    """Return an object of a class of launch."""
    site = language.machine.stack[-1] if language.machine.stack else None
    frame = given.frame if given is not None else None
    file = frame.unit.key if frame is not None else site.unit.key if site is not None else language.reading.file
    line = given.call.line if given is not None and given.call is not None else site.line if site is not None else 1
    location = language.reading.at(file, line)
    return Instance(
        kind=Kind(("launch", name)),
        fields=fields,
        given=given if given is not None else Arguments([]),
        location=location,
        names=_CLASSES.get(name, ()),
    )


def initialise(instance: Instance, given: Arguments) -> None:
    """Run the `__init__` that an object of a class of the build has from the class of launch that it extends."""
    instance.fields.update(_bound(instance.names, given))
    instance.given = given


# Functions


Fields = dict[str, Value]


def _first(fields: Fields) -> Value:
    return next(iter(fields.values()), Unknown("it is not given"))


def joined_path(values: tuple[Value, ...]) -> Value:
    """Return `os.path.join`; `PREFIX/share/NAME/...` is the folder of the package NAME that it is."""
    path = joined([text_of(launch_text(value)) if isinstance(value, Instance) else value for value in values])
    parts = path.parts if isinstance(path, Text) else ()
    if len(parts) < 2 or not isinstance(parts[0], Later) or parts[0].part.kind != "find-pkg-prefix":  # noqa: PLR2004 - prefix and rest
        return path
    name, rest = parts[0].part.arguments[0], parts[1]
    if len(name) != 1 or not isinstance(name[0], str) or not isinstance(rest, str):
        return path
    share = f"/share/{name[0]}"
    if rest != share and not rest.startswith(f"{share}/"):
        return path
    return Text((f"package://{name[0]}{rest[len(share) :]}", *parts[2:]))


def _join(language: LaunchPython, fields: Fields, given: Arguments) -> Value:
    del language, given
    return joined_path(tuple(fields.values()))


def _share(language: LaunchPython, name: Value) -> Value:
    name = language.resolved(name)
    package = name.exact if isinstance(name, Text) else None
    return Text.of(f"package://{package}") if package is not None else later("find-pkg-share", launch_text(name))


def _variable(language: LaunchPython, fields: Fields, given: Arguments) -> Value:
    del given
    name, default = launch_text(_first(fields)), fields.get("default", fields.get("*1"))
    variable = later("env", name, launch_text(default)) if isinstance(default, Text) else later("env", name)
    return language.resolved(variable) if language.reading.context is not None else variable


def exists(language: LaunchPython, path: Value) -> Value:
    """Return whether a file exists; a file outside of the build may still exist at run time."""
    text = language.resolved(path)
    exact = text.exact if isinstance(text, Text) else None
    if exact is not None and language.reading.find(exact) is not None:
        return Truth(True)
    return Unknown(f"whether the file {exact or 'named here'} exists")


def opened(language: LaunchPython, path: Value) -> Value:
    """Return an open file; its text is unknown if it cannot be read."""
    reading, text = language.reading, language.resolved(path)
    exact = text.exact if isinstance(text, Text) else None
    file = reading.find(exact) if exact is not None else None
    data = reading.files.read(file) if file is not None else None
    if data is None or file is None:
        why = reason_of(path) if exact is None else f"the file {exact} is not in the build"
        return create(language, _FILE, {"text": Unknown(why)})
    content = Text.of(data.decode("utf-8", "replace")[:_MOST_TEXT])
    language.machine.place(content, file)
    return create(language, _FILE, {"text": content})


def _listed(language: LaunchPython, folder: Value, pattern: str = "*") -> Value:
    """Return the paths below a folder that fit a pattern, sorted: what `glob` finds."""
    text = language.resolved(folder)
    exact = text.exact if isinstance(text, Text) else None
    paths = language.reading.files.names(exact) if exact is not None else None
    if exact is None or paths is None:
        return Unknown(reason_of(text) if exact is None else f"the files in {exact}")
    depth = pattern.count("/")
    names = dict.fromkeys("/".join(path.split("/")[: depth + 1]) for path in paths if path.count("/") >= depth)
    language.machine.step(len(paths) // 20)
    return Sequence(tuple(Text.of(f"{exact}/{name}") for name in names if fnmatch(name, pattern)))


def _glob(language: LaunchPython, path: Value) -> Value:
    """`glob.glob(path)`; `*` in the names of folders is not read."""
    text = language.resolved(path)
    if not isinstance(text, Text) or text.exact is None:
        return Unknown(reason_of(text))
    folder, _, pattern = text.exact.rpartition("/")
    return _listed(language, Text.of(folder), pattern)


def found_below(language: LaunchPython, folder: Text, given: Arguments) -> Value:
    """Return what `glob` and `iterdir` of a path give; without a pattern that is known, all that is in the folder."""
    pattern = given.values[0] if given.values else None
    exact = pattern.exact if isinstance(pattern, Text) else None
    return _listed(language, folder, exact or "*")


def _names(language: LaunchPython, folder: Value) -> Value:
    """`os.listdir(folder)`."""
    paths = _listed(language, folder)
    if not isinstance(paths, Sequence):
        return paths
    return Sequence(tuple(Text.of(posixpath.basename(str(plain(path)))) for path in paths.items))


def _expression(language: LaunchPython, source: Value) -> Value:
    """Return the value of a text with an expression: `eval` and `ast.literal_eval`."""
    text = language.resolved(source)
    if not isinstance(text, Text) or text.exact is None:
        return Unknown(reason_of(text))
    try:
        return _of_python(language, evaluate_text(text.exact, Dialect()))
    except (ExpressionError, UnknownValueError, UnsupportedError) as error:
        return Unknown(f"`{text.exact[:40]}` cannot be evaluated: {error}")


def _of_python(language: LaunchPython, value: object) -> Value:
    language.machine.step()
    if isinstance(value, bool):
        return Truth(value)
    if isinstance(value, int | float):
        return Number(value, repr(value))
    if isinstance(value, list | tuple):
        return Sequence(tuple(_of_python(language, item) for item in value))
    if isinstance(value, dict):
        return Mapping(tuple((_of_python(language, key), _of_python(language, one)) for key, one in value.items()))
    return NULL if value is None else Text.of(value) if isinstance(value, str) else Unknown("what `eval` returns")


def _document(language: LaunchPython, of: Value) -> Value:
    text = of.fields["text"] if isinstance(of, Instance) and of.name == _FILE else language.resolved(of)
    exact = text.exact if isinstance(text, Text) else None
    if exact is None:
        return Unknown(reason_of(text))
    place = language.machine.places.get(id(text))
    return read_yaml(language.machine, exact, place[1] if place is not None else None)


def _length(language: LaunchPython, fields: Fields, given: Arguments) -> Value:
    of = _first(fields)
    if isinstance(of, Sequence) and any(guarded(item)[1] or isinstance(item, Unknown) for item in of.items):
        return Unknown("not all items are known")
    return python.call(language, ("builtins", "len"), given) or Unknown("the length is not known")


def _dictionary(language: LaunchPython, fields: Fields, given: Arguments) -> Value:
    """Return `dict(...)`; the place of its keys is the call."""
    table = python.call(language, ("builtins", "dict"), replace(given, values=[_first(fields)] if given.values else []))
    if not isinstance(table, Mapping) or given.call is None or given.frame is None:
        return table or Unknown("it is not a dictionary")
    lines = {name: getattr(one, "line", given.call.line) for name, one in given.call.keywords}
    pairs = [(replace(key) if isinstance(key, Text) else key, value) for key, value in table.items]
    for key, _ in pairs:
        exact = key.exact if isinstance(key, Text) else None
        language.machine.place(key, given.frame.unit.key, lines.get(exact or "", given.call.line))
    return replace(table, items=tuple(pairs))


def _holds(language: LaunchPython, expression: Value) -> Value:
    """`evaluate_condition_expression(context, expression)`."""
    value = language.reading.perform(expression)
    word = value.exact.strip().lower() if isinstance(value, Text) and value.exact is not None else ""
    if word in ("true", "1", "false", "0"):
        return Truth(word in ("true", "1"))
    return Unknown(reason_of(value))


def _performed(language: LaunchPython, of: Value) -> Value:
    return language.reading.perform(of)


def _exit(language: LaunchPython, fields: Fields, given: Arguments) -> Value:
    from kg.launch.files.ros2.python.machine import EXIT  # noqa: PLC0415 - each needs the other

    del language, fields, given
    return EXIT


def _prefix(language: LaunchPython, name: Value) -> Value:
    del language
    return later("find-pkg-prefix", launch_text(name))


_FOUND: Final[dict[str, Callable[[LaunchPython, Value], Value]]] = {
    "FindPackage": _prefix,
    "FindPackagePrefix": _prefix,
    "FindPackageShare": _share,
}
"""The folder that `find` of a substitution returns, by its class."""
_OF_ONE: Final[dict[str, Callable[[LaunchPython, Value], Value]]] = {
    **dict.fromkeys(("get_package_share_directory", "get_package_share_path"), _share),
    "get_package_prefix": _prefix,
    **dict.fromkeys(("os.path.exists", "os.path.isfile"), exists),
    "builtins.open": opened,
    **dict.fromkeys(("yaml.safe_load", "yaml.load", "yaml.full_load", "json.load", "json.loads"), _document),
    "evaluate_condition_expression": _holds,
    **dict.fromkeys(("perform_substitutions", "perform_typed_substitution"), _performed),
    **dict.fromkeys(("glob.glob", "glob.iglob"), _glob),
    "os.listdir": _names,
    **dict.fromkeys(("builtins.eval", "ast.literal_eval"), _expression),
}
"""Functions that are evaluated at once, of their first argument but the context."""
_WITH_CONTEXT: Final = frozenset(
    {"evaluate_condition_expression", "perform_substitutions", "perform_typed_substitution"}
)
_FUNCTIONS: Final[dict[str, Callable[[LaunchPython, Fields, Arguments], Value]]] = {
    **dict.fromkeys(("os.path.join", "pathlib.Path", "pathlib.PurePath", "pathlib.PosixPath"), _join),
    **dict.fromkeys(("os.getenv", "os.environ.get"), _variable),
    "builtins.len": _length,
    "builtins.dict": _dictionary,
    "normalize_to_list_of_substitutions": lambda language, fields, given: create(
        language, "TextSubstitution", {"text": _first(fields)}, given
    ),
    **dict.fromkeys(("sys.exit", "builtins.exit", "builtins.quit"), _exit),
}
"""Others that are evaluated at once."""

NAMES: Final = frozenset({*_CLASSES, *(name for name in (*_OF_ONE, *_FUNCTIONS) if "." not in name)})


# Methods


def method(language: LaunchPython, of: Instance, name: str, given: Arguments) -> Value:
    """Return the result of a method of an object of launch."""
    reading, machine = language.reading, language.machine
    if is_substitution(of) and name in ("perform", "evaluate"):
        return reading.perform(of)
    if of.name in _FOUND and name == "find":
        return _FOUND[of.name](language, _first(_bound(("package_name",), given)))
    if of.name == "process_file" and name in ("toxml", "toprettyxml"):
        return of
    if of.name in CONDITIONS and name == "evaluate":
        return _evaluated(language, of)
    if of.name == "LaunchDescription" and name in ("add_action", "add_entity"):
        added = _bound(("action" if name == "add_action" else "entity",), given)
        assert given.call is not None and given.frame is not None  # noqa: PT018, S101 - methods are called by code
        file, line = given.frame.unit.key, given.call.line
        sequence = Sequence(tuple(machine.placed(value, file, line) for value in added.values()))
        entities = of.fields.get("entities", Sequence(()))
        if not isinstance(entities, Sequence):
            entities = Sequence((entities,))
        machine.write(of.fields, "entities", machine.computed("+", (entities, sequence)))
        return NULL
    if of.name == "LaunchDescription" and name in ("describe_sub_entities", "get_launch_arguments"):
        entities = of.fields.get("entities", Sequence(()))
        if name == "describe_sub_entities" or not isinstance(entities, Sequence):
            return entities
        listed = [one for one in entities.items if isinstance(one, Instance) and one.name == "DeclareLaunchArgument"]
        return replace(entities, items=tuple(listed))
    if of.name == CONFIGURATIONS and name == "get":
        fields = _bound(("key", "default"), given)
        setting = language.configuration(of, language.resolved(_first(fields)))
        unset = isinstance(setting, Unknown) and setting.reason.endswith("is not set")
        return fields.get("default", NULL) if unset else setting
    if of.name == "LaunchContext" and name == "perform_substitution":
        return reading.perform(_first(_bound(("substitution",), given)))
    if of.name == _FILE:
        return _of_file(of, name)
    return Unknown(reason_of(of))


def _of_file(of: Instance, name: str) -> Value:
    text = of.fields["text"]
    if name == "read" or isinstance(text, Unknown):
        return text
    if name == "readlines" and isinstance(text, Text):
        return Sequence(tuple(map(Text.of, (text.exact or "").splitlines(keepends=True))))
    return NULL if name == "close" else Unknown(f"`{name}` of a file is not read")


def _evaluated(language: LaunchPython, of: Instance) -> Value:
    context, test = language.reading.context, condition(of)
    if context is None or test.value is None:
        return Unknown(f"the condition `{test.written}` is evaluated where it cannot be known")
    text = context.perform(test.value).strip().lower()
    if text not in ("true", "1", "false", "0"):
        return Unknown(f"it depends on `{test.written}`")
    return Truth((text in ("true", "1")) is not test.negated)


def with_holes(text: str, reason: str) -> Text:
    """Return the executor's result for a text; its holes are unknown for the reason."""
    if HOLE not in text:
        return Text.of(text)
    pieces = text.split(HOLE)
    parts = [one for piece in pieces[1:] for one in (Text.hole(reason).parts[0], piece)]
    kept = tuple(part for part in (pieces[0], *parts) if part != "")
    return Text(kept, as_text(Unknown(reason)).resolution, None, reason)


PATH_METHODS: Final[Names[str, Callable[[LaunchPython, Text], Value]]] = {
    "exists": exists,
    "is_file": exists,
    "open": opened,
    "read_text": lambda language, of: _of_file(opened(language, of), "read"),  # type: ignore[arg-type]  # it is one
}
"""Methods of a path that need its file."""
