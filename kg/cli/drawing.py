"""Shared parts of commands that draw: the output format and its destination."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Annotated, Final

from kg.cli.diagnostics import say
from kg.cli.options import option
from kg.cli.output import save, terminal, write_bytes
from kg.errors import UsageError

_ENDINGS: Final = {
    ".svg": "svg",
    ".dot": "dot",
    ".gv": "dot",
    ".mmd": "mermaid",
    ".mermaid": "mermaid",
    ".json": "json",
    ".md": "markdown",
    ".txt": "text",
}

Svg = Annotated[bool, option("--svg", "Draw it as SVG; on a terminal into a file named after it.")]
Dot = Annotated[bool, option("--dot", "Write it in the language of Graphviz.")]
Mermaid = Annotated[bool, option("--mermaid", "Write it as a flow chart of Mermaid.")]
Output = Annotated[str | None, option("--output -o FILE", "Write to FILE, in the form of its ending.")]


def form_of(flags: Mapping[str, bool], output: str | None) -> str:
    """Return the format of a flag or of the file name's suffix; `text` without either.

    UsageError KG003 for two flags, or an unknown suffix.
    """
    chosen = [form for form, is_given in flags.items() if is_given]
    if len(chosen) > 1:
        raise UsageError("KG003", f"--{chosen[0]} and --{chosen[1]} do not go together", hint="Choose one form.")
    if chosen:
        return chosen[0]
    ending = Path(output or "").suffix
    forms = {ending: form for ending, form in _ENDINGS.items() if form in flags or form == "text"}
    if ending and ending not in forms:
        hint = f"Write to {', '.join(f'*{one}' for one in forms)}, or name the form with a flag."
        raise UsageError("KG003", f"this cannot be written as `{ending}`", hint=hint)
    return forms.get(ending, "text")


def deliver(text: str, form: str, output: str | None, name: str) -> None:
    """Write `text` to the given file or to standard output; on a terminal, write pictures to `name`.svg."""
    if output == "-" or (output is None and not (form == "svg" and terminal())):
        write_bytes(text.encode())
        return
    path = Path(output or f"{name}.svg")
    save(path, text.encode())
    say(f"wrote {path}")
