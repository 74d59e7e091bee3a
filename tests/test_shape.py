"""The shape of the code: what is not enforced drifts. Messages name the offender."""

from __future__ import annotations

import ast
import re
from typing import TYPE_CHECKING

from repository import ROOT, Module, Routine, modules

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

FILE_LINES = 700
FUNCTION_LINES = 80
BROAD_EXCEPTS = 5

PRODUCT = modules("kg")
EVERYTHING = modules("kg", "tests", "benchmarks", "docs")


def lines(routine: Routine) -> int:
    """Lines of a function from `def` to its end."""
    return (routine.end_lineno or routine.lineno) - routine.lineno + 1


def sized_functions(chosen: Sequence[Module]) -> list[tuple[int, str]]:
    """Pair each function's length with its place."""
    return [
        (lines(routine), f"{module}:{routine.lineno} {routine.name}")
        for module in chosen
        for routine in module.routines()
    ]


def public(tree: ast.Module | ast.ClassDef, within: str = "") -> Iterator[tuple[str, ast.ClassDef | Routine]]:
    """Yield the public classes, functions and methods with their dotted names."""
    for node in tree.body:
        if not isinstance(node, ast.ClassDef | ast.FunctionDef | ast.AsyncFunctionDef) or node.name.startswith("_"):
            continue
        yield within + node.name, node
        if isinstance(node, ast.ClassDef):
            yield from public(node, f"{within}{node.name}.")


def overload(node: ast.ClassDef | Routine) -> bool:
    """Whether a function is only another signature of the one below it."""
    return any(ast.unparse(decorator) in {"overload", "typing.overload"} for decorator in node.decorator_list)


def untyped(routine: Routine) -> list[str]:
    """Return the arguments without a type, and `return` where it has none."""
    arguments = routine.args
    named = [*arguments.posonlyargs, *arguments.args, *arguments.kwonlyargs]
    named += [argument for argument in (arguments.vararg, arguments.kwarg) if argument]
    bare = [argument.arg for argument in named if argument.annotation is None and argument.arg not in {"self", "cls"}]
    return bare if routine.returns is not None else [*bare, "return"]


def test_no_file_is_longer_than_its_limit() -> None:
    """No file of the product, its tests, benchmarks or documentation scripts is longer than the limit."""
    assert not [f"{module} ({module.length})" for module in EVERYTHING if module.length > FILE_LINES]


def test_no_function_is_longer_than_its_limit() -> None:
    """No function of the product, its tests, benchmarks or documentation scripts is longer than the limit."""
    assert not [f"{name} ({size})" for size, name in sized_functions(EVERYTHING) if size > FUNCTION_LINES]


def test_every_module_says_what_lives_there() -> None:
    """Every module of the product has a docstring."""
    assert not [str(module) for module in PRODUCT if not ast.get_docstring(module.tree)]


def test_every_public_name_is_documented() -> None:
    """Every public class, function and method of the product has a docstring."""
    missing = [
        f"{module}:{node.lineno} {name}"
        for module in PRODUCT
        for name, node in public(module.tree)
        if not ast.get_docstring(node) and not overload(node)
    ]
    assert not missing


def test_every_function_is_typed() -> None:
    """Every argument and every result has a type, in tests and benchmarks too."""
    bare = [
        f"{module}:{routine.lineno} {routine.name}: {', '.join(untyped(routine))}"
        for module in EVERYTHING
        for routine in module.routines()
        if untyped(routine)
    ]
    assert not bare


def test_every_test_states_the_behaviour() -> None:
    """Every test has a docstring; its first line is a sentence."""
    silent = [
        f"{module}:{routine.lineno} {routine.name}"
        for module in modules("tests")
        for routine in module.routines()
        if routine.name.startswith("test_") and not (ast.get_docstring(routine) or "").split("\n")[0].endswith(".")
    ]
    assert not silent


def test_every_exception_to_a_tool_gives_its_reason() -> None:
    """`noqa` and `type: ignore` name the rule, and a reason stands behind them."""
    exception = re.compile(r"#\s*(noqa|type:\s*ignore)(?P<rest>.*)")
    reasoned = re.compile(r"(: [A-Z0-9, ]+|\[[a-z-, ]+\])\s+.*\w{3}")
    bare = [
        f"{module}:{number}: {line.strip()}"
        for module in EVERYTHING
        for number, line in enumerate(module.text.splitlines(), 1)
        if (found := exception.search(line)) and "re.compile" not in line and not reasoned.match(found["rest"])
    ]
    assert not bare


def test_broad_excepts_are_few() -> None:
    """Five places swallow every exception: programs that begin, or serve many; none clean up and raise, or hand on."""
    broad = [
        f"{module}:{node.lineno}"
        for module in PRODUCT
        for node in ast.walk(module.tree)
        if isinstance(node, ast.ExceptHandler)
        and (node.type is None or ast.unparse(node.type) in {"Exception", "BaseException"})
        and not isinstance(node.body[-1], ast.Raise)
        and not ast.unparse(node.body[-1]).endswith(".set_exception(error)")
    ]
    assert len(broad) <= BROAD_EXCEPTS, broad


def test_no_open_work_is_left_in_comments() -> None:
    """Open work stands in issues, not in the code."""
    words = re.compile(r"#.*\b(TODO|FIXME|XXX|HACK)\b")
    found = [
        f"{module}:{number}: {line.strip()}"
        for module in PRODUCT
        for number, line in enumerate(module.text.splitlines(), 1)
        if words.search(line)
    ]
    assert not found


def test_tests_mirror_sources() -> None:
    """A folder of tests bears the name of a room of the product."""
    rooms = {module.path.parent.relative_to(ROOT / "tests") for module in modules("tests")}
    assert not [str(room) for room in rooms if not (ROOT / "kg" / room).is_dir()]
