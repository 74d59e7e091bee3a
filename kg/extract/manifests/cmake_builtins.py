"""The commands of CMake that compute: variables, lists, strings, paths, files, and includes."""

from __future__ import annotations

import posixpath
import re
from typing import TYPE_CHECKING, Final

from kg.extract.manifests.cmake_run import BINARY, DEFINING, SOURCE, Run, macros_of
from kg.extract.manifests.cmake_scope import keep_matching, replace_all, split_list
from kg.lazily import lazily

if TYPE_CHECKING:
    from collections.abc import Callable

with lazily():
    from kg.extract.python.evaluation import Dialect, evaluate_text


_LARGEST: Final = 1 << 63


def compute(expression: str) -> int | None:
    """Return the value of an expression of whole numbers, which are Python's; None for anything else."""
    from kg.extract.python.evaluation import ExpressionError, UnsupportedError  # noqa: PLC0415 - few packages compute

    try:
        value = evaluate_text(expression, Dialect())
    except (ExpressionError, UnsupportedError):
        return None
    return int(value) if isinstance(value, int | float) and abs(value) < _LARGEST else None


_PATTERN_WORK: Final = 1000
_FIND_WORDS: Final = frozenset({"REQUIRED", "QUIET", "EXACT", "MODULE", "CONFIG", "NO_MODULE", "GLOBAL"})
_PROJECT_WORDS: Final = frozenset({"VERSION", "DESCRIPTION", "HOMEPAGE_URL", "LANGUAGES", "COMPAT_VERSION"})


def _set(run: Run, words: list[str]) -> None:
    if not words:
        return
    name, values = words[0], words[1:]
    certain = run.certain
    scope = run.scope
    if values[-1:] == ["PARENT_SCOPE"]:
        values, scope = values[:-1], run.scope.parent or run.scope
    if "CACHE" in values:
        values, certain = values[: values.index("CACHE")], False
    if name.startswith("ENV{"):
        return
    scope.set(name, ";".join(values), certain=certain) if values else scope.unset(name)


def _unset(run: Run, words: list[str]) -> None:
    scope = run.scope.parent if words[-1:] == ["PARENT_SCOPE"] and run.scope.parent else run.scope
    scope.unset(words[0] if words else "")


def _option(run: Run, words: list[str]) -> None:
    """An option can be switched in each build, so it is never certain."""
    if words and words[0] not in run.scope.variables:
        run.scope.set(words[0], words[2] if len(words) > 2 else "OFF", certain=False)  # noqa: PLR2004  (option(NAME "help" VALUE))


def _list(run: Run, words: list[str]) -> None:
    if len(words) < 2:  # noqa: PLR2004  (list(ACTION NAME ...))
        return
    action, name, rest = words[0], words[1], words[2:]
    certain = run.certain and name not in run.scope.uncertain
    items = split_list(run.scope.variables.get(name, ""))
    if action in _READERS:
        if rest:
            run.scope.set(rest[-1], _READERS[action](items, rest), certain=certain)
    elif action in _CHANGERS:
        run.scope.set(name, ";".join(_CHANGERS[action](items, rest)), certain=certain)


def _filter(items: list[str], rest: list[str]) -> list[str]:
    if len(rest) < 3:  # noqa: PLR2004  (list(FILTER NAME INCLUDE REGEX pattern))
        return items
    return keep_matching(rest[2], items, wanted=rest[0] == "INCLUDE")


def _transform(items: list[str], rest: list[str]) -> list[str]:
    match rest:
        case ["APPEND", text, *_]:
            return [item + text for item in items]
        case ["PREPEND", text, *_]:
            return [text + item for item in items]
        case ["REPLACE", pattern, text, *_]:
            return [replace_all(pattern, text, item) for item in items]
        case ["TOLOWER" | "TOUPPER" | "STRIP" as how, *_]:
            return [_CASES[how](item) for item in items]
    return items


def _insert(items: list[str], rest: list[str]) -> list[str]:
    index = int(rest[0]) if rest and re.fullmatch(r"-?\d{1,6}", rest[0]) else 0
    return items[:index] + rest[1:] + items[index:]


def _element(items: list[str], rest: list[str]) -> str:
    indices = [int(word) for word in rest[:-1] if re.fullmatch(r"-?\d{1,6}", word)]
    return ";".join(items[index] for index in indices if -len(items) <= index < len(items))


_CASES: Final[dict[str, Callable[[str], str]]] = {"TOLOWER": str.lower, "TOUPPER": str.upper, "STRIP": str.strip}
_READERS: Final[dict[str, Callable[[list[str], list[str]], str]]] = {
    "LENGTH": lambda items, _: str(len(items)),
    "GET": _element,
    "JOIN": lambda items, rest: rest[0].join(items),
    "FIND": lambda items, rest: str(items.index(rest[0]) if rest[0] in items else -1),
}
_CHANGERS: Final[dict[str, Callable[[list[str], list[str]], list[str]]]] = {
    "APPEND": lambda items, rest: items + [part for word in rest for part in split_list(word)],
    "PREPEND": lambda items, rest: [part for word in rest for part in split_list(word)] + items,
    "REMOVE_ITEM": lambda items, rest: [item for item in items if item not in rest],
    "REMOVE_AT": lambda items, rest: [item for index, item in enumerate(items) if str(index) not in rest],
    "REMOVE_DUPLICATES": lambda items, _: list(dict.fromkeys(items)),
    "REVERSE": lambda items, _: items[::-1],
    "SORT": lambda items, _: sorted(items),
    "INSERT": _insert,
    "FILTER": _filter,
    "TRANSFORM": _transform,
}


def _string(run: Run, words: list[str]) -> None:
    certain = run.certain
    match words:
        case ["REGEX", "REPLACE", pattern, text, name, *rest]:
            run.scope.set(name, replace_all(pattern, text, "".join(rest)), certain=certain)
        case ["REPLACE", old, new, name, *rest] if old:
            run.scope.set(name, "".join(rest).replace(old, new), certain=certain)
        case ["TOLOWER" | "TOUPPER" | "STRIP" as how, text, name]:
            run.scope.set(name, _CASES[how](text), certain=certain)
        case ["CONCAT", name, *rest]:
            run.scope.set(name, "".join(rest), certain=certain)
        case ["APPEND", name, *rest]:
            run.scope.set(name, run.scope.variables.get(name, "") + "".join(rest), certain=certain)
        case ["PREPEND", name, *rest]:
            run.scope.set(name, "".join(rest) + run.scope.variables.get(name, ""), certain=certain)
        case ["JOIN", glue, name, *rest]:
            run.scope.set(name, glue.join(rest), certain=certain)


def _get_filename_component(run: Run, words: list[str]) -> None:
    if len(words) < 3:  # noqa: PLR2004  (get_filename_component(NAME path WHAT))
        return
    name, path, what = words[:3]
    base = posixpath.basename(path)
    values = {
        "NAME": base,
        "NAME_WE": base.partition(".")[0],
        "NAME_WLE": posixpath.splitext(base)[0],
        "EXT": "." + base.partition(".")[2] if "." in base else "",
        "DIRECTORY": posixpath.dirname(path),
        "PATH": posixpath.dirname(path),
        "ABSOLUTE": posixpath.normpath(posixpath.join(run.folder, path)),
        "REALPATH": posixpath.normpath(posixpath.join(run.folder, path)),
    }
    run.scope.set(name, values.get(what, path), certain=run.certain)


def _file(run: Run, words: list[str]) -> None:
    match words:
        case ["GLOB" | "GLOB_RECURSE" as how, name, *rest]:
            run.scope.set(name, ";".join(_glob(run, rest, recurse=how == "GLOB_RECURSE")))
        case ["RELATIVE_PATH", name, base, path]:
            run.scope.set(name, posixpath.relpath(path, base) if base and path else path, certain=run.certain)


def _configure_file(run: Run, words: list[str]) -> None:
    """configure_file(template output): record the template of the output, in case a target compiles it."""
    if len(words) > 1:
        template = run.files.locate(words[0], run.folder)
        folder = run.scope.variables.get("CMAKE_CURRENT_BINARY_DIR", BINARY)
        output = posixpath.normpath(posixpath.join(folder, words[1]))
        if template and run.files.exists(template):
            run.files.generated[output] = (template, run.files.configured(template, run.scope.variables))


def _math(run: Run, words: list[str]) -> None:
    """math(EXPR NAME "expression") for whole numbers."""
    if len(words) >= 3 and words[0] == "EXPR":  # noqa: PLR2004  (the three words of the form above)
        value = compute(words[2])
        run.scope.set(words[1], "" if value is None else str(value), certain=run.certain and value is not None)


def _glob(run: Run, words: list[str], *, recurse: bool) -> list[str]:
    relative = words[words.index("RELATIVE") + 1] if "RELATIVE" in words[:-1] else None
    skipped = {"RELATIVE", "CONFIGURE_DEPENDS", "FOLLOW_SYMLINKS", relative}
    paths: dict[str, None] = {}
    for pattern in words:
        if pattern not in skipped and pattern not in {"LIST_DIRECTORIES", "true", "false"}:
            run.spend(_PATTERN_WORK + 4 * run.files.size)
            for path in run.files.glob(pattern, run.folder, recurse=recurse):
                whole = posixpath.join(SOURCE, path)
                paths[posixpath.relpath(whole, relative) if relative else whole] = None
    return list(paths)


def _aux_source_directory(run: Run, words: list[str]) -> None:
    if len(words) == 2:  # noqa: PLR2004  (aux_source_directory(folder NAME))
        patterns = [f"{words[0]}/*.{ending}" for ending in ("c", "cc", "cpp", "cxx")]
        before = split_list(run.scope.variables.get(words[1], ""))
        run.scope.set(words[1], ";".join(before + _glob(run, patterns, recurse=False)))


def _include(run: Run, words: list[str]) -> None:
    path = run.files.module(words[0], run.scope.variables.get("CMAKE_CURRENT_LIST_DIR", run.folder)) if words else None
    if path is None and words:
        path = run.files.module(words[0], run.folder)
    if path:
        run.run_file(path, own_folder=False)


def _add_subdirectory(run: Run, words: list[str]) -> None:
    folder = run.files.locate(words[0], run.folder) if words else None
    path = f"{folder}/CMakeLists.txt" if folder else "CMakeLists.txt"
    if folder is not None and run.files.exists(path) and posixpath.join(SOURCE, folder) != run.folder:
        run.run_file(path, own_folder=True)


def _add_project(run: Run, words: list[str]) -> None:
    """ExternalProject_Add(name ... SOURCE_DIR folder): build a folder of the sources as a project of its own."""
    if "SOURCE_DIR" in words[:-1]:
        _add_subdirectory(run, [words[words.index("SOURCE_DIR") + 1]])


def _project(run: Run, words: list[str]) -> None:
    """project(name ...); one whose name only a module outside can compute keeps that of the package."""
    if words and words[0] not in _PROJECT_WORDS:
        run.scope.set("PROJECT_NAME", words[0])
        run.scope.set("CMAKE_PROJECT_NAME", run.scope.variables.get("CMAKE_PROJECT_NAME", words[0]))
        for name in ("PROJECT_SOURCE_DIR", f"{words[0]}_SOURCE_DIR"):
            run.scope.set(name, run.folder)


def _find_package(run: Run, words: list[str]) -> None:
    """Note the packages found: their libraries go by their names, and their macros may be called."""
    if not words:
        return
    listed = words[words.index("COMPONENTS") + 1 :] if "COMPONENTS" in words else []
    components = [word for word in listed if word not in _FIND_WORDS and word != "OPTIONAL_COMPONENTS"]
    if words[0] == "catkin":
        before = split_list(run.scope.variables.get("catkin_LIBRARIES", ""))
        run.scope.set("catkin_LIBRARIES", ";".join(dict.fromkeys(before + components)))
        run.files.packages.update(dict.fromkeys(components))
        for component in components:
            run.scope.set(f"{component}_LIBRARIES", component)
    else:
        run.files.packages[words[0]] = None
        run.scope.set(f"{words[0]}_LIBRARIES", words[0])


def _parse_arguments(run: Run, words: list[str]) -> None:
    """cmake_parse_arguments(prefix options one-value multi-value args...), also as PARSE_ARGV from an index."""
    if words[:1] == ["PARSE_ARGV"]:
        given = split_list(run.scope.variables.get("ARGV", ""))
        start = int(words[1]) if words[1:2] and words[1].isdecimal() else 0
        words = [*words[2:6], *given[start:]]
    if len(words) < 4:  # noqa: PLR2004  (the prefix and three lists of keywords)
        return
    prefix = words[0]
    options, single, multiple = (split_list(text) for text in words[1:4])
    values: dict[str, list[str]] = {"UNPARSED_ARGUMENTS": []}
    current, room = "UNPARSED_ARGUMENTS", True
    for word in words[4:]:
        if word in options:
            values[word], current, room = ["TRUE"], "UNPARSED_ARGUMENTS", True
        elif word in single or word in multiple:
            current, room = word, True
            values.setdefault(word, [])
        elif room:
            values[current].append(word)
            room = current not in single
        else:
            values["UNPARSED_ARGUMENTS"].append(word)
    for name in (*options, *single, *multiple, "UNPARSED_ARGUMENTS"):
        value = values.get(name)
        default = "FALSE" if name in options else ""
        run.scope.set(f"{prefix}_{name}", ";".join(value) if value else default)


def _defining(command: str) -> Callable[[Run, list[str]], None]:
    return lambda run, words: run.macros.update(macros_of(command, words))


HANDLERS: Final[dict[str, Callable[[Run, list[str]], None]]] = {
    "set": _set,
    "unset": _unset,
    "option": _option,
    "list": _list,
    "string": _string,
    "file": _file,
    "configure_file": _configure_file,
    "math": _math,
    "get_filename_component": _get_filename_component,
    "aux_source_directory": _aux_source_directory,
    "include": _include,
    "add_subdirectory": _add_subdirectory,
    "externalproject_add": _add_project,
    "project": _project,
    "find_package": _find_package,
    "cmake_parse_arguments": _parse_arguments,
    **{command: _defining(command) for command in DEFINING},
}
