"""KG221: examples that cannot be read."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, Final

from kg.errors import Place, RuleError
from kg.rules.authoring.examples import read_examples
from kg.rules.checks.finding import Finding, from_error

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path

    from kg.rules.checks.finding import Context
    from kg.rules.files import RuleFile

__all__ = ["CODE", "TITLE", "check", "orphan"]

CODE: Final = "KG221"
TITLE: Final = "examples malformed"


def check(file: RuleFile, _context: Context) -> Iterator[Finding]:
    """Yield the first reason why the examples of a file cannot be read; the rule runs all the same."""
    if file.examples.is_file():
        try:
            read_examples(file.examples)
        except RuleError as error:
            yield replace(from_error(error, file.name, Place(str(file.examples), 1, 1)), severity="warning")


def orphan(path: Path, name: str) -> Finding | None:
    """Return the note that a page of examples has no rule next to it; None for a page without examples."""
    try:
        read_examples(path)
    except RuleError:
        return None
    hint = f"Name the rule {path.stem}.rq, {path.stem}.srl or {path.stem}.ttl, or remove the page."
    return Finding(CODE, "note", name, "no rule belongs to these examples", Place(str(path), 1, 1), hint)
