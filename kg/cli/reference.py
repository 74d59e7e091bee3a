"""All commands with their manuals: what `kg --spec` prints."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from kg.cli.manual import Page, page
from kg.errors import Exit
from kg.settings import DECLARED


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
