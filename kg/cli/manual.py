"""The content of `--help`, docs/cli.md and `kg --spec` for a command, extracted from its function.

A command's docstring is its text: paragraphs are filled, indented blocks (examples) are kept.
"""

from __future__ import annotations

import inspect
import shutil
import textwrap
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any, Final

from kg.errors import Exit
from kg.settings import DECLARED

_WIDEST: Final = 100
_INDENT: Final = "  "
_LISTS: Final = {"Arguments", "Options"}  # sections that are not groups of commands


@dataclass(frozen=True, slots=True)
class Entry:
    """An argument, option or command with its sentence."""

    name: str
    sentence: str


@dataclass(frozen=True, slots=True)
class Page:
    """The manual of one command; `sections` are titled lists of arguments, options and commands."""

    path: str
    usage: str
    text: str
    sections: tuple[tuple[str, tuple[Entry, ...]], ...]
    epilogue: str


def page(command: Any, context: Any) -> Page:
    """Return the manual of a typer command in its context."""
    arguments = [param for param in command.params if param.param_type_name == "argument" and not param.hidden]
    options = [param for param in command.get_params(context) if param.param_type_name == "option" and not param.hidden]
    commands: dict[str, list[Entry]] = {}
    for panel, name, sentence in command.commands.entries() if hasattr(command, "commands") else ():
        commands.setdefault(panel, []).append(Entry(name, sentence))
    sections = [
        ("Arguments", tuple(Entry(_argument(param), param.help or "") for param in arguments)),
        *((title, tuple(entries)) for title, entries in commands.items()),
        ("Options", tuple(Entry(_option(param), param.help or "") for param in options)),
    ]
    usage = " ".join([context.command_path, "[OPTIONS]", *(_argument(param) for param in arguments)])
    if getattr(command, "commands", None):
        usage += " COMMAND ..."
    return Page(
        context.command_path,
        usage,
        inspect.cleandoc(command.help or ""),
        tuple(section for section in sections if section[1]),
        inspect.cleandoc(command.epilog or ""),
    )


def _argument(param: Any) -> str:
    name = param.metavar or param.name.upper()
    dots = "..." if param.nargs == -1 else ""
    return f"{name}{dots}" if param.required else f"[{name}{dots}]"


def _option(param: Any) -> str:
    names = ", ".join(sorted(param.opts, key=len)) + "".join(f" / {name}" for name in param.secondary_opts)
    return names if param.is_flag else f"{names} {param.metavar or param.name.upper()}"


def first_paragraph(command: Any) -> str:
    """Return the first paragraph of a command's help."""
    return " ".join(inspect.cleandoc(command.help or "").split("\n\n")[0].split())


def plain(manual: Page, columns: int | None = None) -> str:
    """Return a manual as text of at most `columns` columns (default: the terminal's, up to 100)."""
    columns = columns or min(shutil.get_terminal_size().columns, _WIDEST)
    parts = [_fill(f"Usage: {manual.usage}", columns, later="         "), *_paragraphs(manual.text, columns)]
    names = [entry.name for title, entries in manual.sections if title not in _LISTS for entry in entries]
    for title, entries in manual.sections:
        aligned = [entry.name for entry in entries] if title in _LISTS else names
        longest = min(max(map(len, aligned)), columns // 3)
        parts.append("\n".join([f"{title}:", *(_row(entry, longest, columns) for entry in entries)]))
    return "\n\n".join([*parts, *_paragraphs(manual.epilogue, columns)])


def _paragraphs(text: str, columns: int) -> list[str]:
    return [part if part.startswith("    ") else _fill(part, columns) for part in text.split("\n\n") if part.strip()]


def _fill(text: str, columns: int, *, later: str = "") -> str:
    return textwrap.fill(" ".join(text.split()), columns, subsequent_indent=later, break_on_hyphens=False)


def _row(entry: Entry, longest: int, columns: int) -> str:
    indent = " " * (longest + 2 * len(_INDENT))
    if len(entry.name) <= longest:
        lead = f"{_INDENT}{entry.name:<{longest}}{_INDENT}"
    else:
        lead = f"{_INDENT}{entry.name}\n{indent}"
    first, *following = textwrap.wrap(entry.sentence, columns - len(indent), break_on_hyphens=False) or [""]
    return (lead + first).rstrip() + "".join(f"\n{indent}{line}" for line in following)


def description(context: Any) -> dict[str, Any]:
    """Return all commands with their arguments and options, the settings and the exit codes, for JSON.

    `context` is that of the whole program.
    """
    manuals = [page(context.command, context), *pages(context.command, context)]
    return {
        "commands": [
            {
                "command": manual.path,
                "usage": manual.usage,
                "text": manual.text,
                **{
                    title.lower(): [{"name": entry.name, "about": entry.sentence} for entry in entries]
                    for title, entries in manual.sections
                    if title in {"Arguments", "Options"}
                },
            }
            for manual in manuals
        ],
        "settings": [
            {
                "setting": one.name,
                "flag": one.flag,
                "variable": one.variable,
                "value": one.metavar,
                "default": one.default if isinstance(one.default, int | float | str) else None,
                "about": one.sentence,
            }
            for one in DECLARED.values()
        ],
        "exit_codes": {code.name.lower(): int(code) for code in Exit},
    }


def pages(group: Any, context: Any) -> Iterator[Page]:
    """Yield the manual of each command of a group, in its context, and of its subgroups."""
    for name, command in group.commands.items():
        if command.hidden:
            continue
        inner = type(context)(command, info_name=name, parent=context)
        yield page(command, inner)
        if getattr(command, "commands", None):
            yield from pages(command, inner)
