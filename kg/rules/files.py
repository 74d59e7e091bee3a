"""Rules as files: the content of a rule file of any notation.

    rules/communication/publishes.rq       the rule, its documentation in a header of comments
    rules/communication/publishes.md       its examples

A header has the same form in the three notations, all of which begin comments with `#`:

    # Nodes publish to the topics of their publishers       the title, one line
    #
    # ## What it infers
    #
    # Any number of lines of prose.
    #
    # ## Why
    # ## How to fix                                         may be missing: of rules that find faults
    # ## Known limits                                       may be missing
    # ## References                                         may be missing
    #
    # since: 0.2
    # severity: warning                                     only for rules that report: error, warning or note
"""

from __future__ import annotations

import re
from dataclasses import dataclass, field, replace
from hashlib import blake2b
from typing import TYPE_CHECKING, Final

from kg.codes import SEVERITIES
from kg.errors import Fix, Place, RuleError
from kg.similar import similar, suggest
from kg.syntax.names import PREFIXES

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping
    from pathlib import Path

    from pyoxigraph import Triple

    from kg.rules.form import Rule
    from kg.rules.stratify import Stratum

_BYTES: Final = 16

HEADINGS: Final = ("What it infers", "Why", "How to fix", "Known limits", "References")
"""The headings that documentation may have, in their order."""

REQUIRED_HEADINGS: Final = ("What it infers", "Why")

NOTATIONS: Final = {".rq": "SPARQL CONSTRUCT", ".ttl": "SHACL rules", ".srl": "SPARQL 1.2 RL"}
"""The ending of a file of rules to the name of its notation."""


@dataclass(frozen=True, slots=True)
class Documentation:
    """The header of a file; `sections` by heading, their text without the comment signs."""

    title: str = ""
    sections: Mapping[str, str] = field(default_factory=dict)
    since: str | None = None
    severity: str | None = None


def family_of(name: str) -> str:
    """Return the family of a rule: the first part of its name, empty for a name without a slash."""
    first, slash, _ = name.partition("/")
    return first if slash else ""


@dataclass(frozen=True, slots=True)
class RuleFile:
    """One file of rules, read; `name` is `family/name`, with folders between where a family has some."""

    name: str
    path: Path
    text: str
    documentation: Documentation
    rules: tuple[Rule, ...]
    data: tuple[Triple, ...] = ()
    """Triples that the file itself states (`DATA` of SPARQL 1.2 RL)."""
    prefixes: Mapping[str, str] = field(default_factory=dict)
    pack: str = ""
    """The rule pack that brought it; empty for folders."""

    @property
    def family(self) -> str:
        """The first part of the name; empty for a file that is in no folder of its own."""
        return family_of(self.name)

    @property
    def all_prefixes(self) -> dict[str, str]:
        """The prefixes that names in it may have: those that it declares, and those that need no declaration."""
        return {**PREFIXES, **self.prefixes}

    @property
    def notation(self) -> str:
        """The ending of the file."""
        return self.path.suffix

    @property
    def examples(self) -> Path:
        """Path of its examples, whether it exists or not."""
        return self.path.with_suffix(".md")


@dataclass(frozen=True, slots=True)
class RuleSet:
    """The rule files in force, sorted by name."""

    files: tuple[RuleFile, ...]
    strata: tuple[Stratum, ...] = ()
    """The order in which the rules run, where it is known already."""
    cached_digest: str = ""
    """The digest, where it is known already."""
    patterns: frozenset[str] = frozenset()
    """What the rules read and derive (`kg.rules.dependencies.patterns`), where it is known already."""

    @property
    def digest(self) -> str:
        """Digest that distinguishes the rules and data of one set from others."""
        return self.cached_digest or blake2b(repr((self.rules, self.data)).encode(), digest_size=_BYTES).hexdigest()

    @property
    def rules(self) -> tuple[Rule, ...]:
        """The rules of all files."""
        return tuple(rule for file in self.files for rule in file.rules)

    @property
    def data(self) -> tuple[Triple, ...]:
        """The triples that files state."""
        return tuple(triple for file in self.files for triple in file.data)


_KEY: Final = re.compile(r"(since|severity):\s*(\S*)\s*")


def parse_header(text: str, path: str) -> Documentation:
    """Return the documentation in the comments that a text begins with; an empty one when it begins with none.

    Raises RuleError: KG206 for a heading that is unknown or appears twice, and for a severity that there is not.
    """
    title = ""
    sections: dict[str, list[str]] = {}
    keys: dict[str, str] = {}
    section: list[str] | None = None
    for number, line, column, whole in _comments(text):
        place = Place(path, number, column, whole)
        if line.startswith("## "):
            section = sections.setdefault(_heading(line[3:].strip(), sections, place), [])
        elif match := _KEY.fullmatch(line):
            keys[match[1]] = _value(match[1], match[2], place)
            section = None
        elif section is not None:
            section.append(line)
        elif not title:
            title = line.strip()
    written = {heading: "\n".join(lines).strip("\n") for heading, lines in sections.items()}
    return Documentation(title, written, keys.get("since"), keys.get("severity"))


def _comments(text: str) -> list[tuple[int, str, int, str]]:
    """Return the lines of the header: number, what is behind the comment sign, the column of that, all of the line."""
    comments: list[tuple[int, str, int, str]] = []
    for number, line in enumerate(text.splitlines(), 1):
        if line.startswith("#"):
            comments.append((number, line[1:].removeprefix(" ").rstrip(), 3, line))
        elif comments or line.strip():
            break
    return comments


def _heading(heading: str, before: dict[str, list[str]], place: Place) -> str:
    if heading not in HEADINGS:
        raise _unknown("heading", heading, f"The headings are: {', '.join(HEADINGS)}.", HEADINGS, place)
    if heading in before:
        raise RuleError("KG206", f"the heading `{heading}` appears twice", place=place, hint="Join the two parts.")
    return heading


def _unknown(what: str, written: str, hint: str, valid: Iterable[str], place: Place) -> RuleError:
    """Return the error about a word in the line of a place that is none of those known."""
    near = similar(written, valid)
    start = (place.excerpt or "").rfind(written) + 1
    word = replace(place, column=start, end_line=place.line, end_column=start + len(written))
    fixes = [Fix(each, word) for each in near]
    return RuleError("KG206", f"unknown {what} `{written}`", place=place, hint=suggest(near) or hint, fixes=fixes)


def _value(key: str, value: str, place: Place) -> str:
    if key == "severity" and value not in SEVERITIES:
        raise _unknown("severity", value, f"The severities are: {', '.join(SEVERITIES)}.", SEVERITIES, place)
    if not value:
        raise RuleError("KG206", f"`{key}:` has no value", place=place, hint="Write the version, as in `since: 0.2`.")
    return value
