"""The syntax of CMake's language (cmake-language(7)): text becomes commands, commands become blocks."""

from __future__ import annotations

import re
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Final

if TYPE_CHECKING:
    from collections.abc import Iterator

_GAP: Final = re.compile(r"(?:\s|#\[(?P<level>=*)\[.*?\](?P=level)\]|#(?!\[=*\[)[^\n]*)+", re.DOTALL)
_NAME: Final = re.compile(r"([A-Za-z_][A-Za-z0-9_]*)[ \t]*\(")
_ARGUMENT: Final = re.compile(
    r"""
        "(?P<quoted>(?:[^"\\]|\\.)*+)"
      | (?P<paren>[()])
      | (?P<unquoted>(?:\$\([A-Za-z0-9_]*\)|[^\s()\#"\\]|\\.|(?<=[^\s()\#])"(?:[^"\\]|\\.)*+")++)
    """,
    re.DOTALL | re.VERBOSE,
)
_BRACKET: Final = re.compile(r"\[(={0,40})\[\n?")
_CONTINUED: Final = re.compile(r"(?<!\\)((?:\\\\)*)\\\n")
_OPENERS: Final = {
    "if": "endif",
    "foreach": "endforeach",
    "while": "endwhile",
    "macro": "endmacro",
    "function": "endfunction",
}
_CLOSERS: Final = {closer: opener for opener, closer in _OPENERS.items()}


@dataclass(frozen=True, slots=True)
class Argument:
    """One argument as written: `form` is `unquoted`, `quoted`, `bracket` or `paren` (a nested parenthesis)."""

    text: str
    form: str


@dataclass(frozen=True, slots=True)
class Command:
    """One command invocation; `name` is in lower case."""

    name: str
    arguments: tuple[Argument, ...]
    line: int


@dataclass(slots=True)
class Block:
    """A compound statement: `branches` pairs each opening command (if, elseif, else; foreach; ...) with its body."""

    branches: list[tuple[Command, list[Statement]]] = field(default_factory=list)


Statement = Command | Block


class SyntaxFault(ValueError):  # noqa: N818  (a finding about the user's file, not an error of the program)
    """The text does not follow the grammar from `line` on; the commands before are sound."""

    def __init__(self, message: str, line: int) -> None:
        super().__init__(message)
        self.message = message
        self.line = line


def parse(text: str) -> tuple[list[Statement], list[SyntaxFault]]:
    """Return the statements of a file and its faults; a block that is not closed ends with the file."""
    commands: list[Command] = []
    faults: list[SyntaxFault] = []
    try:
        parse_commands(text, commands)
    except SyntaxFault as fault:
        faults.append(fault)
    return _blocks(commands, faults), faults


def parse_commands(text: str, into: list[Command] | None = None) -> list[Command]:
    """Return the commands of a file; raises `SyntaxFault`, with those before the fault left in `into`."""
    into = [] if into is None else into
    text = text.replace("\r\n", "\n")
    lexer = _Lexer(text)
    position = _skip(text, 0)
    while position < len(text):
        match = _NAME.match(text, position)
        line = lexer.line(position)
        if match is None:
            raise SyntaxFault("a command is expected here", line)
        arguments, position = lexer.arguments(match.end(), line)
        into.append(Command(match[1].lower(), tuple(arguments), line))
        position = _skip(text, position)
    return into


def _skip(text: str, position: int) -> int:
    match = _GAP.match(text, position)
    return match.end() if match else position


class _Lexer:
    """Reads arguments and counts lines, at positions that only grow."""

    def __init__(self, text: str) -> None:
        self._text = text
        self._position = 0
        self._line = 1
        self._unclosed: set[str] = set()
        """Closing brackets that do not stand in the rest of the text, so that it is searched once for each."""

    def line(self, position: int) -> int:
        """Return the line of a position, which must not lie before the last one asked for."""
        self._line += self._text.count("\n", self._position, position)
        self._position = position
        return self._line

    def arguments(self, position: int, start: int) -> tuple[list[Argument], int]:
        """Return the arguments from behind the parenthesis that opens them, and the position behind its match."""
        arguments: list[Argument] = []
        depth = 0
        while True:
            position = _skip(self._text, position)
            if position >= len(self._text):
                raise SyntaxFault("the command is not closed", start)
            argument, position = self._argument(position)
            if argument.form == "paren":
                depth += 1 if argument.text == "(" else -1
                if depth < 0:
                    return arguments, position
            arguments.append(argument)

    def _argument(self, position: int) -> tuple[Argument, int]:
        bracket = _BRACKET.match(self._text, position)
        closing = f"]{bracket[1]}]" if bracket else ""
        if bracket and closing not in self._unclosed:
            end = self._text.find(closing, bracket.end())
            if end >= 0:
                return Argument(self._text[bracket.end() : end], "bracket"), end + len(closing)
            self._unclosed.add(closing)
        match = _ARGUMENT.match(self._text, position)
        if match is None:
            raise SyntaxFault("an argument is expected here", self.line(position))
        form = match.lastgroup or ""
        text = _CONTINUED.sub(r"\1", match[form]) if form == "quoted" else match[form]
        return Argument(text, form), match.end()


def _blocks(commands: list[Command], faults: list[SyntaxFault]) -> list[Statement]:
    """Nest commands into blocks, without recursion: no depth of nesting can exhaust the stack."""
    top: list[Statement] = []
    open_blocks: list[Block] = []
    for command in commands:
        body = open_blocks[-1].branches[-1][1] if open_blocks else top
        if command.name in _OPENERS:
            block = Block([(command, [])])
            body.append(block)
            open_blocks.append(block)
        elif command.name in {"elseif", "else"} and open_blocks:
            open_blocks[-1].branches.append((command, []))
        elif command.name in _CLOSERS:
            if open_blocks:
                open_blocks.pop()
            else:
                faults.append(SyntaxFault(f"{command.name}() closes nothing", command.line))
        else:
            body.append(command)
    faults.extend(_unclosed(open_blocks))
    return top


def _unclosed(open_blocks: list[Block]) -> Iterator[SyntaxFault]:
    for block in open_blocks[:1]:
        opener = block.branches[0][0]
        yield SyntaxFault(f"{opener.name}() is not closed", opener.line)
