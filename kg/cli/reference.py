"""docs/cli.md, generated from the commands by `docs/generate.py`."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any, Final

import typer
from typer.main import get_command

from kg.cli.manual import Page, page
from kg.errors import Exit
from kg.settings import DECLARED

_HEAD: Final = """\
# The command line

<!-- Written by docs/generate.py from the commands themselves. -->

"""
_STREAMS: Final = """\
## Output

Results go to standard output. Notes, warnings, errors and progress go to standard error. Off a terminal, output has no
colour, no progress bar and unlimited line length. Lists become TSV with a header; `--json` prints JSON Lines, one
object per line. If rows are left out, a note names the option that shows them. `kg` ends quietly if the reader closes
the pipe.

On a terminal, query results are tables of at most `--limit` rows (1000 by default). `?file` and `?line` become one
clickable place. Elsewhere results are SPARQL 1.1 TSV, complete unless `--limit` is given. Graphs are Turtle. `--format`
selects another format.

`kg completions` prints a shell script that completes commands, options, and names of nodes, packages and queries.
`kg --spec` prints this page as JSON.

Options that are [settings](settings.md) can also be set in the environment or in `kg.toml`. Their variable is listed in
brackets below.

An error has a code (run `kg explain CODE`), a place if known, and a hint:

    error[KG002]: unknown setting `stroe`
     --> kg.toml:2
      |
    2 | stroe = "x"
    help: Did you mean `store`?

"""


def markdown() -> str:
    """Return docs/cli.md."""
    from kg.cli.app import app  # noqa: PLC0415 - so that the program can be described without running it

    root = get_command(app)
    context = typer.Context(root, info_name="kg", **root.context_settings)
    parts = [_HEAD, *_top(page(root, context)), _STREAMS]
    for manual in pages(root, context):
        parts += _command(manual)
    return "".join(parts).rstrip() + "\n"


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


def _top(manual: Page) -> Iterator[str]:
    yield f"```text\n{manual.usage}\n```\n\n{manual.text}\n\n"
    for title, entries in manual.sections:
        yield f"**{title}**\n\n"
        link = title not in {"Options", "Arguments"}
        for entry in entries:
            name = f"[`kg {entry.name}`](#kg-{entry.name})" if link else f"`{entry.name}`"
            yield f"* {name}: {entry.sentence}\n"
        yield "\n"
    yield f"{manual.epilogue}\n\n"


def _command(manual: Page) -> Iterator[str]:
    yield f"## {manual.path}\n\n```text\n{manual.usage}\n```\n\n{manual.text}\n\n"
    for title, entries in manual.sections:
        if title == "Commands":
            continue
        yield f"| {title.lower().removesuffix('s')} | meaning |\n| --- | --- |\n"
        for entry in entries:
            yield f"| `{_cell(entry.name)}` | {_cell(entry.sentence)} |\n"
        yield "\n"


def _cell(text: str) -> str:
    return text.replace("|", "\\|")
