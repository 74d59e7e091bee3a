"""The shape of the code. Messages name the offender."""

from __future__ import annotations

import ast
import re
from typing import TYPE_CHECKING, Final

from repository import ROOT, Module, Routine, modules

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

FILE_LINES = 700
FUNCTION_LINES = 80
BROAD_EXCEPTS = 5

EXCEPTION: Final = re.compile(r"#\s*(noqa|type:\s*ignore)(?P<rest>.*)")
REASONED: Final = re.compile(r"(: [A-Z0-9, ]+|\[[a-z-, ]+\])\s+.*\w{3}")
OPEN_WORK: Final = re.compile(r"#.*\b(TODO|FIXME|XXX|HACK)\b")


def lines(routine: Routine) -> int:
    """Return the lines of a function from `def` to its end."""
    return (routine.end_lineno or routine.lineno) - routine.lineno + 1


def public(tree: ast.Module | ast.ClassDef, within: str = "") -> Iterator[tuple[str, ast.ClassDef | Routine]]:
    """Yield the public classes, functions and methods with their dotted names."""
    for node in tree.body:
        if not isinstance(node, ast.ClassDef | ast.FunctionDef | ast.AsyncFunctionDef) or node.name.startswith("_"):
            continue
        yield within + node.name, node
        if isinstance(node, ast.ClassDef):
            yield from public(node, f"{within}{node.name}.")


def overload(node: ast.ClassDef | Routine) -> bool:
    """Whether a function is only another signature of the next one."""
    return any(ast.unparse(decorator) in {"overload", "typing.overload"} for decorator in node.decorator_list)


def untyped(routine: Routine) -> list[str]:
    """Return the arguments without a type, and `return` if it has none."""
    arguments = routine.args
    named = [*arguments.posonlyargs, *arguments.args, *arguments.kwonlyargs]
    named += [argument for argument in (arguments.vararg, arguments.kwarg) if argument]
    bare = [argument.arg for argument in named if argument.annotation is None and argument.arg not in {"self", "cls"}]
    return bare if routine.returns is not None else [*bare, "return"]


def long_files(module: Module) -> Iterator[str]:
    """Yield a file longer than the limit."""
    if module.length > FILE_LINES:
        yield f"{module} ({module.length})"


def long_functions(module: Module) -> Iterator[str]:
    """Yield the functions longer than the limit."""
    for routine in module.routines:
        if lines(routine) > FUNCTION_LINES:
            yield f"{module}:{routine.lineno} {routine.name} ({lines(routine)})"


def untyped_functions(module: Module) -> Iterator[str]:
    """Yield the functions with an untyped argument or result."""
    for routine in module.routines:
        if bare := untyped(routine):
            yield f"{module}:{routine.lineno} {routine.name}: {', '.join(bare)}"


def unreasoned_exceptions(module: Module) -> Iterator[str]:
    """Yield the tool exceptions without a rule or a reason."""
    for number, line in enumerate(module.text.splitlines(), 1):
        if (found := EXCEPTION.search(line)) and "re.compile" not in line and not REASONED.match(found["rest"]):
            yield f"{module}:{number}: {line.strip()}"


def undescribed_modules(module: Module) -> Iterator[str]:
    """Yield a module without a docstring."""
    if not ast.get_docstring(module.tree):
        yield str(module)


def undocumented_names(module: Module) -> Iterator[str]:
    """Yield the public classes, functions and methods without a docstring."""
    for name, node in public(module.tree):
        if not ast.get_docstring(node) and not overload(node):
            yield f"{module}:{node.lineno} {name}"


def broad_excepts(module: Module) -> Iterator[str]:
    """Yield the handlers that catch every exception."""
    for node in module.handlers:
        if (
            (node.type is None or ast.unparse(node.type) in {"Exception", "BaseException"})
            and not isinstance(node.body[-1], ast.Raise)
            and not ast.unparse(node.body[-1]).endswith(".set_exception(error)")
        ):
            yield f"{module}:{node.lineno}"


def open_work(module: Module) -> Iterator[str]:
    """Yield the comments about unfinished work."""
    for number, line in enumerate(module.text.splitlines(), 1):
        if OPEN_WORK.search(line):
            yield f"{module}:{number}: {line.strip()}"


def silent_tests(module: Module) -> Iterator[str]:
    """Yield the tests whose docstring does not begin with a sentence."""
    for routine in module.routines:
        if routine.name.startswith("test_") and not (ast.get_docstring(routine) or "").split("\n")[0].endswith("."):
            yield f"{module}:{routine.lineno} {routine.name}"


def folders_without_room(module: Module) -> Iterator[str]:
    """Yield the folder of a test without a counterpart in the product."""
    room = module.path.parent.relative_to(ROOT / "tests")
    if not (ROOT / "kg" / room).is_dir():
        yield str(room)


ANYWHERE: Final = (long_files, long_functions, untyped_functions, unreasoned_exceptions)
OF_PRODUCT: Final = (undescribed_modules, undocumented_names, broad_excepts, open_work)
OF_TESTS: Final = (silent_tests, folders_without_room)
CHECKS: Final = (*ANYWHERE, *OF_PRODUCT, *OF_TESTS)


def findings() -> dict[Callable[[Module], Iterator[str]], list[str]]:
    """Return the findings of each check, in one pass because parsing dominates the cost."""
    found: dict[Callable[[Module], Iterator[str]], list[str]] = {check: [] for check in CHECKS}
    folders = set()
    for module in modules("kg", "tests", "benchmarks", "docs"):
        folder = module.path.relative_to(ROOT).parts[0]
        folders.add(folder)
        special = {"kg": OF_PRODUCT, "tests": OF_TESTS}.get(folder, ())
        for check in (*ANYWHERE, *special):
            found[check] += check(module)
    assert folders == {"kg", "tests", "benchmarks", "docs"}
    return found


def test_code_has_its_shape() -> None:
    """The checks report only the few allowed broad excepts: in entry points, or in loops that serve many.

    One test, because the pass is expensive and several tests would repeat it in each worker; the error lists all
    findings.
    """
    found = findings()
    if len(found[broad_excepts]) <= BROAD_EXCEPTS:
        del found[broad_excepts]
    assert not {check.__name__: places for check, places in found.items() if places}
