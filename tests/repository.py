"""Shared by tests of the whole repository: its files and the shape of its Python code."""

from __future__ import annotations

import ast
import subprocess
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING, Final, TypeAlias

if TYPE_CHECKING:
    from collections.abc import Iterator

__all__ = ["ROOT", "Module", "Routine", "files", "modules"]

ROOT: Final = Path(__file__).resolve().parent.parent

Routine: TypeAlias = ast.FunctionDef | ast.AsyncFunctionDef

_NOT_OURS: Final = {"dist", "node_modules", "vendor", "__pycache__"}
_BODIES: Final = ("body", "handlers", "orelse", "finalbody", "cases")
"""The fields with statements, handlers and cases."""


@cache
def files() -> tuple[Path, ...]:
    """Return the files of the repository: those tracked by git or not ignored, or all files without git."""
    command = ["git", "-C", str(ROOT), "ls-files", "-z", "--cached", "--others", "--exclude-standard"]
    try:
        listed = subprocess.run(command, capture_output=True, check=True).stdout.decode().split("\0")
        found = [ROOT / name for name in listed if name]
    except (OSError, subprocess.CalledProcessError):
        found = [path for path in ROOT.rglob("*") if _ours(path.relative_to(ROOT).parts)]
    return tuple(sorted({path for path in found if path.is_file()}))


def _ours(parts: tuple[str, ...]) -> bool:
    hidden = parts[0].startswith(".") and parts[0] not in {".ci", ".gitignore"}
    return not hidden and not _NOT_OURS & set(parts) and not parts[0].endswith(".egg-info")


@dataclass(frozen=True, slots=True)
class Module:
    """A Python file of the repository, parsed."""

    path: Path
    text: str
    tree: ast.Module
    routines: tuple[Routine, ...]
    """Every function and method, nested ones too."""
    handlers: tuple[ast.ExceptHandler, ...]
    """Every `except`."""

    def __str__(self) -> str:
        return str(self.path.relative_to(ROOT))

    @property
    def length(self) -> int:
        """Lines of the file."""
        return self.text.count("\n")


def modules(*folders: str) -> Iterator[Module]:
    """Yield the Python files below the folders, except the extraction cases; all trees together take 600 MB."""
    for path in files():
        parts = path.relative_to(ROOT).parts
        if path.suffix == ".py" and parts[0] in folders and "cases" not in parts:
            text = path.read_text(encoding="utf-8")
            tree = ast.parse(text, str(path))
            statements = list(_statements(tree))
            routines = [node for node in statements if isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef)]
            handlers = [node for node in statements if isinstance(node, ast.ExceptHandler)]
            yield Module(path, text, tree, tuple(routines), tuple(handlers))


def _statements(within: ast.AST) -> Iterator[ast.AST]:
    """Yield the statements below a node, and what holds statements; expressions are most of a tree and hold none."""
    for field in _BODIES:
        for node in getattr(within, field, ()):
            yield node
            yield from _statements(node)
