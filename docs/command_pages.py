"""docs/cli.md and the manual page docs/kg.1 in roff, written from the commands themselves."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Final

import typer
from typer.main import get_command

from kg.cli.app import app
from kg.cli.manual import page, pages
from kg.settings import DECLARED

if TYPE_CHECKING:
    from collections.abc import Iterator

    from kg.cli.manual import Page

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


def _program() -> tuple[Any, Any]:
    """Return `kg` as typer has it, and its context."""
    root = get_command(app)
    return root, typer.Context(root, info_name="kg", **root.context_settings)


def markdown() -> str:
    """Return docs/cli.md."""
    root, context = _program()
    parts = [_HEAD, *_top(page(root, context)), _STREAMS]
    for manual in pages(root, context):
        parts += _command(manual)
    return "".join(parts).rstrip() + "\n"


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


_FILES = (
    (".kg/", "The store: the nearest in the working folder or above is used, unless --store names another."),
    ("kg.toml", "Settings, looked for in the working folder and above."),
)


def roff() -> str:
    """Return docs/kg.1, in the format of man(7)."""
    root, context = _program()
    top = page(root, context)
    lines = ['.TH KG 1 "" "kg" "User Commands"', ".SH NAME", r"kg \- index the ROS nodes of a workspace"]
    lines += [".SH SYNOPSIS", f".B {_text(top.usage)}", ".SH DESCRIPTION", *_prose(top.text), ".SH OPTIONS"]
    lines += _entries(top, {"Options"})
    lines.append(".SH COMMANDS")
    for manual in pages(root, context):
        lines += [f".SS {_text(manual.path)}", f".B {_text(manual.usage)}", ".PP", *_prose(manual.text)]
        lines += _entries(manual, {"Arguments", "Options"})
    lines.append(".SH ENVIRONMENT AND SETTINGS")
    for one in DECLARED.values():
        lines += _entry(f"{one.variable}, {one.name} in kg.toml, {one.flag} {one.metavar}", one.sentence)
    lines.append(".SH FILES")
    lines += [line for name, sentence in _FILES for line in _entry(name, sentence)]
    lines.append(".SH STREAMS AND EXIT STATUS")
    lines += _prose(top.epilogue)
    return "\n".join(lines) + "\n"


def _entries(manual: Page, titles: set[str]) -> list[str]:
    chosen = [entry for title, entries in manual.sections if title in titles for entry in entries]
    return [line for entry in chosen for line in _entry(entry.name, entry.sentence)]


def _entry(name: str, sentence: str) -> list[str]:
    return [".TP", f".B {_text(name)}", _text(" ".join(sentence.split()))]


def _prose(text: str) -> list[str]:
    """Return paragraphs; indented lines are examples and keep their breaks."""
    lines: list[str] = []
    for part in text.split("\n\n"):
        if part.startswith("    "):
            lines += [".PP", ".nf", *(_text(line) for line in part.splitlines()), ".fi"]
        elif part.strip():
            lines += [".PP", _text(" ".join(part.split()))]
    return lines


def _text(text: str) -> str:
    """Return text escaped for roff, with hyphens that can be copied."""
    escaped = text.replace("\\", r"\e").replace("-", r"\-")
    return rf"\&{escaped}" if escaped.lstrip().startswith((".", "'")) else escaped
