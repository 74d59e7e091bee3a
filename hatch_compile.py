"""Compile the interpreter and the C++ front end on it with mypyc, for a wheel of one platform.

    python hatch_compile.py FOLDER

mypyc makes native classes, but not of data classes with slots, and it reads their annotations when a module is loaded,
which fails for those that stand behind `TYPE_CHECKING`. So the modules are compiled from a copy in which each data
class has the methods that `dataclass` would give it. Every line keeps its number, so that tracebacks name the lines of
the files that are shipped beside. `dataclasses.replace` works on such a class; its `repr` is that of `object`.
"""

from __future__ import annotations

import ast
import os
import shutil
import subprocess
import sys
from pathlib import Path
from typing import Any, Final

__all__ = ["MODULES", "REQUIRED", "CompileError", "build", "rewritten"]

REQUIRED: Final = ("mypy[mypyc]>=2.4,<2.5", "setuptools>=65")
"""What a build that compiles needs."""
MODULES: Final = {
    "kg/symbolic": "binding containers durations effects form kinds machine names operators parameters results spelling"
    " state values",
    "kg/extract/cpp": "callbacks calls construction copies kinds language library linking tokens units",
}
"""The modules that take most of the time of extraction."""
_OPEN: Final = frozenset({"Machine", "Framework", "Object", "Unit"})
"""Classes with subclasses in modules that are not compiled."""
_PLAIN: Final = frozenset({"Function", "Class", "CppFunction", "CppClass"})
"""Classes that stay as they are: they fill their slots at the first use."""
_HEAD: Final = (
    "; from dataclasses import field as _field, make_dataclass; from typing import Any, ClassVar"
    "; _make: Any = make_dataclass; _of: Any = _field; _PARAMS: Any = _make('_', []).__dataclass_params__"
    "; _plain: Any = lambda cls: cls"
)
"""What follows the import of `annotations`, on its line."""
_PARAMETERS: Final = "__dataclass_params__: ClassVar[Any] = _PARAMS"
_SETTINGS: Final = """[mypy]
explicit_package_bases = True
ignore_missing_imports = True
follow_imports = silent
[mypy-kg.api,kg.rules.*,kg.search.*,kg.wiring.*,kg.graph.*,kg.pipeline.*,kg.query.*,kg.store.*,kg.lint.*,kg.language.*]
follow_imports = skip
"""


class CompileError(Exception):
    """Why the modules could not be compiled."""


def build(root: Path, folder: Path) -> dict[Path, str]:
    """Compile the modules of a checkout in an empty folder; return the libraries with their paths in the wheel.

    CompileError with the last words of the compiler when it fails.
    """
    shutil.copytree(
        root / "kg", folder / "kg", ignore=lambda _, names: [n for n in names if "." in n and n[-3:] != ".py"]
    )
    for path in _paths():
        (folder / path).write_text(rewritten((folder / path).read_text("utf-8")), "utf-8")
    (folder / "mypy.ini").write_text(_SETTINGS, "utf-8")
    done = subprocess.run(  # noqa: S603 - this file
        [sys.executable, Path(__file__).resolve(), "."],
        cwd=folder,
        env={**os.environ, "MYPYPATH": "."},
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
        check=False,
    )
    made = folder / "made"
    if done.returncode:
        raise CompileError("\n".join(done.stdout.splitlines()[-20:]))
    return {path: str(path.relative_to(made)) for path in made.rglob("*.so")}


def _paths() -> list[str]:
    return [f"{folder}/{name}.py" for folder, names in MODULES.items() for name in names.split()]


def rewritten(source: str) -> str:
    """Return a module as mypyc takes it, with each line at its place."""
    tree = ast.parse(source)
    lines = source.split("\n")
    for statement in tree.body:
        if isinstance(statement, ast.ImportFrom) and statement.module == "__future__":
            lines[statement.lineno - 1] += _HEAD
        elif isinstance(statement, ast.If) and ast.unparse(statement.test) == "TYPE_CHECKING":
            lines[(statement.body[0].end_lineno or 0) - 1] += "; from mypy_extensions import mypyc_attr"
        elif isinstance(statement, ast.ClassDef):
            _rewrite(statement, lines)
    return "\n".join(lines)


def _rewrite(cls: ast.ClassDef, lines: list[str]) -> None:
    """Rewrite a class in the lines of its module."""
    data = next((one for one in cls.decorator_list if ast.unparse(one).startswith("dataclass")), None)
    before = min([cls.lineno, *(one.lineno for one in cls.decorator_list)]) - 2
    if cls.name in _OPEN | _PLAIN and lines[before]:
        raise CompileError(f"the line before the class {cls.name} is not empty")
    if cls.name in _PLAIN:
        lines[before] = "@_plain"
        for one in _fields(cls):  # as text, since mypyc would look the types up when the class is made
            row, note = one.lineno - 1, one.annotation
            lines[row] = f'{lines[row][: note.col_offset]}"{ast.unparse(note)}"{lines[row][note.end_col_offset :]}'
        return
    if data is not None:
        _replace_body(cls, data, lines)
    if cls.name in _OPEN:
        lines[before] = "@mypyc_attr(allow_interpreted_subclasses=True)"


def _fields(cls: ast.ClassDef) -> list[ast.AnnAssign]:
    return [one for one in cls.body if isinstance(one, ast.AnnAssign)]


def _replace_body(cls: ast.ClassDef, data: ast.expr, lines: list[str]) -> None:
    """Put the methods that a data class gets in place of its docstring and its fields."""
    options = {one.arg: ast.unparse(one.value) == "True" for one in getattr(data, "keywords", ())}
    fields = [(ast.unparse(one.target), ast.unparse(one.annotation), one.value) for one in _fields(cls)]
    parameters, written, compared = ["self"], [], []
    for name, kind, value in fields:
        given = {one.arg: ast.unparse(one.value) for one in value.keywords} if _is_field(value) else {}
        factory = given.get("default_factory")
        default = given.get("default") if given else value and ast.unparse(value)
        parameters.append(
            f"{name}: {kind} | None = None" if factory else f"{name}: {kind}" + (f" = {default}" if default else "")
        )
        written.append(
            f"self.{name}: {kind} = " + (f"({factory})() if {name} is None else {name}" if factory else name)
        )
        if given.get("compare") != "False":
            compared.append(name)
    made = ", ".join(f"({name!r}, Any{_shown(value) if cls.name in _OPEN else ''})" for name, _, value in fields)
    like = f"_make({cls.name!r}, [{made}], init=False, repr=False, eq=False)"
    body = [
        f"__dataclass_fields__: ClassVar[Any] = {like}.__dataclass_fields__; {_PARAMETERS}",
        f"def __init__({', '.join(parameters)}) -> None: {'; '.join(written)}  # type: ignore",
    ]
    if options.get("eq", True):
        equal = " and ".join(f"self.{name} == other.{name}" for name in compared)
        same = f"self is other or (isinstance(other, {cls.name}) and {equal})"
        body.append(f"def __eq__(self, other: object) -> bool: return {same}")
        if options.get("unsafe_hash") or options.get("frozen"):
            body.append(f"def __hash__(self) -> int: return hash(({''.join(f'self.{name}, ' for name in compared)}))")
    first = cls.body[0].lineno - 1
    methods = [one for one in cls.body if isinstance(one, ast.FunctionDef)]
    starts = [min([one.lineno, *(mark.lineno for mark in one.decorator_list)]) - 1 for one in methods]
    last = min(starts) if starts else (cls.end_lineno or 0)
    while not starts and lines[last : last + 2] == ["", ""]:  # but the line before the next class
        last += 1
    if len(body) > last - first:
        raise CompileError(f"the class {cls.name} has too few lines for the methods of its data")
    lines[data.lineno - 1] = ""
    lines[first:last] = [f"    {line}" for line in body] + [""] * (last - first - len(body))


def _is_field(value: ast.expr | None) -> Any:
    return isinstance(value, ast.Call) and ast.unparse(value.func) == "field"


def _shown(value: ast.expr | None) -> str:
    if value is None:
        return ""
    return f", _of{ast.unparse(value).removeprefix('field')}" if _is_field(value) else f", {ast.unparse(value)}"


def main() -> None:
    """Compile the modules of this folder, to `made`."""
    from mypyc.build import mypycify  # noqa: PLC0415 - only a build that compiles has these
    from setuptools import setup  # noqa: PLC0415

    extensions = mypycify(["--config-file=mypy.ini", *_paths()], opt_level="1", debug_level="0", group_name="kg")
    setup(name="kg", packages=[], ext_modules=extensions, script_args=["-q", "build_ext", "--build-lib", "made"])


if __name__ == "__main__":
    main()
