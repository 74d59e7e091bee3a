"""Metrics of a program and of expert code for the same task: the columns of Table 2 of onto-ros (section 4.2).

Lines of code exclude blank lines, comments and docstrings. Components are publishers, subscribers, service clients and
action clients. Message types are those imported from interface packages.
"""

from __future__ import annotations

import ast
import io
import re
import tokenize
from typing import TYPE_CHECKING, Final

import msgspec

from kg.robot.messages import Types
from kg.robot.programs.names import named
from kg.robot.programs.tree import Do, Program, expressions_of, reads_of, statements

if TYPE_CHECKING:
    from collections.abc import Iterator

    from kg.robot.capability import Capabilities

_COMPONENTS: Final = {
    "Publisher": "publishers",
    "create_publisher": "publishers",
    "Subscriber": "subscribers",
    "create_subscription": "subscribers",
    "ServiceProxy": "clients",
    "create_client": "clients",
    "SimpleActionClient": "action_clients",
    "ActionClient": "action_clients",
}
_LIBRARIES: Final = ("rospy", "rclpy")
_INTERFACES: Final = ("msg", "srv", "action")
_STATUS: Final = "GoalStatus"  # the type of goal states in both action client libraries; no node exchanges it
_PART: Final = re.compile("(Action|Goal|Result|Feedback|Request|Response)$")
"""Suffixes of the message types of an action or service."""


class ProgramMetrics(msgspec.Struct, frozen=True, kw_only=True):
    """Number of blocks (statements) and of distinct capabilities of a program."""

    blocks: int
    capabilities: int


class CodeMetrics(msgspec.Struct, frozen=True, kw_only=True):
    """Metrics of Python code with rospy or rclpy."""

    lines: int
    publishers: int
    subscribers: int
    clients: int
    action_clients: int
    message_types: int

    @property
    def components(self) -> int:
        """Publishers, subscribers and clients together."""
        return self.publishers + self.subscribers + self.clients + self.action_clients


def metrics(program: Program, capabilities: Capabilities | None = None) -> ProgramMetrics:
    """Return the metrics of a program; given the capabilities, two names of one count once."""
    program = program if capabilities is None else named(program, capabilities)
    every = [statement for _, statement in statements(program.body)]
    used = {statement.capability for statement in every if isinstance(statement, Do)}
    for statement in every:
        used |= {read.capability for _, one in expressions_of(statement) for read in reads_of(one)}
    return ProgramMetrics(blocks=len(every), capabilities=len(used))


def code_metrics(text: str) -> CodeMetrics:
    """Return the metrics of code; SyntaxError if it is not Python."""
    tree = ast.parse(text)
    counts = dict.fromkeys(_COMPONENTS.values(), 0)
    for node in ast.walk(tree):
        if isinstance(node, ast.Call):
            name = node.func.attr if isinstance(node.func, ast.Attribute) else getattr(node.func, "id", "")
            if name in _COMPONENTS:
                counts[_COMPONENTS[name]] += 1
    return CodeMetrics(lines=_lines(text, tree), message_types=len(set(_imported(tree))), **counts)


def foreign_types(text: str, ros: int) -> list[str]:
    """Return the sorted message types in code that exist only in the other version of ROS."""
    own, other = Types(ros), Types(3 - ros)
    used = sorted({f"{package}/{name}" for package, name in _imported(ast.parse(text))})
    return [name for name in used if own.sort(name) is None and other.sort(name) is not None]


def _imported(tree: ast.Module) -> Iterator[tuple[str, str]]:
    for node in ast.walk(tree):
        package, _, part = (node.module or "").partition(".") if isinstance(node, ast.ImportFrom) else ("", "", "")
        if isinstance(node, ast.ImportFrom) and part in _INTERFACES and package not in _LIBRARIES:
            for name in node.names:
                if name.name != _STATUS:
                    yield package, _PART.sub("", name.name)


def _lines(text: str, tree: ast.Module) -> int:
    blank = {tokenize.COMMENT, tokenize.NL, tokenize.NEWLINE, tokenize.INDENT, tokenize.DEDENT, tokenize.ENDMARKER}
    lines: set[int] = set()
    for token in tokenize.generate_tokens(io.StringIO(text).readline):
        if token.type not in blank:
            lines.update(range(token.start[0], token.end[0] + 1))
    for node in ast.walk(tree):
        if isinstance(node, ast.Module | ast.ClassDef | ast.FunctionDef) and ast.get_docstring(node) is not None:
            first = node.body[0]
            lines.difference_update(range(first.lineno, (first.end_lineno or first.lineno) + 1))
    return len(lines)
