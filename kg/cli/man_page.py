"""kg(1), the manual page in roff, generated from the commands by `docs/generate.py`."""

from __future__ import annotations

import typer
from typer.main import get_command

from kg.cli.manual import Page, page
from kg.cli.reference import pages
from kg.settings import DECLARED

_FILES = (
    (".kg/", "The store: the nearest in the working folder or above is used, unless --store names another."),
    ("kg.toml", "Settings, looked for in the working folder and above."),
)


def roff() -> str:
    """Return the page in the format of man(7)."""
    from kg.cli.app import app  # noqa: PLC0415 - so that the program can be described without running it

    root = get_command(app)
    context = typer.Context(root, info_name="kg", **root.context_settings)
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
