"""The catalogue of error codes and the severities of remarks; docs/errors.md holds the words of each code.

The hundreds digit is the area: 0 usage and settings, 1 reading sources, 2 rules, 3 the store, 4 findings in an
architecture, 5 queries, 6 graph and ontology, 7 search and evaluation, 8 robots, 9 inside `kg` itself.
"""

from __future__ import annotations

import re
from dataclasses import dataclass
from typing import Final

from kg import resources

__all__ = ["CATALOGUE", "LINT_CODES", "PAGE", "SEVERITIES", "CodeEntry"]

SEVERITIES: Final = ("error", "warning", "note")
"""Severities of remarks by `kg lint`, `kg rules check` and headers of rules, from most to least severe."""

PAGE: Final = resources.folder("docs") / "errors.md"
"""The page that `kg explain KG101`, the documentation, editors and the pages of the server share."""
_ENTRY: Final = re.compile(r"^### (KG\d{3}): (.+)\n\n(.+)\n\nFix: (.+)$", re.MULTILINE)


@dataclass(frozen=True, slots=True)
class CodeEntry:
    """Title, explanation and fix of a code."""

    title: str
    explanation: str
    way_out: str


CATALOGUE: Final = {code: CodeEntry(*texts) for code, *texts in _ENTRY.findall(PAGE.read_text("utf-8"))}
"""Entries by code, in ascending order."""

LINT_CODES: Final = frozenset(code for code in CATALOGUE if code.startswith("KG4"))
"""Codes of findings, and of errors in the inputs of `kg lint`."""
