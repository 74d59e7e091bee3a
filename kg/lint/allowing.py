"""Accepted findings with their reasons: entries of `[[lint.allow]]` in kg.toml, and comments in the files.

    [[lint.allow]]
    code = "KG407"
    subject = "/camera/*"       # any name that the finding is about; also file, system, rule
    reason = "the driver of the camera is started by another computer"

A comment is on the line or on a line of its own above it: `<!-- kg: allow KG407 read by the base station -->`, `# kg:
allow KG407 ...` or `// kg: allow KG407 ...`.
"""

from __future__ import annotations

import re
from dataclasses import dataclass
from fnmatch import fnmatchcase
from typing import TYPE_CHECKING, Any, Final, TypeAlias

from kg.codes import LINT_CODES
from kg.errors import Place, UsageError
from kg.lint.lines import Lines
from kg.similar import did_you_mean

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Mapping, Sequence

    from kg.lint.finding import Evidence, Finding
    from kg.settings import Table

_GLOBS: Final = ("subject", "file", "system", "rule")
_KEYS: Final = ("code", *_GLOBS, "reason")
_COMMENT: Final = re.compile(
    r"(?P<sign><!--|#|//|/\*)\s*kg:\s*allow\s+(?P<code>[A-Za-z]+\d+)\b[:,\s]*(?P<reason>.*?)\s*(?:-->|\*/|$)"
)
_HEAD: Final = "[[lint.allow]]"
_Fault: TypeAlias = "tuple[str, Place, str | None]"
"""The error of an entry, its place, and a hint."""


@dataclass(frozen=True, slots=True)
class Allowance:
    """An entry of the allow-list: a code, globs that narrow it, and the reason. `*` in a glob also matches `/`."""

    code: str
    reason: str
    place: Place
    subject: str = "*"
    file: str = "*"
    system: str = "*"
    rule: str = "*"

    def names(self, finding: Finding) -> bool:
        """Return whether the entry matches a finding: its code, and one of its subjects, its file, system and rule."""
        return (
            self.code == finding.code
            and (self.subject == "*" or any(fnmatchcase(one, self.subject) for one in finding.subjects))
            and fnmatchcase(finding.path, self.file)
            and fnmatchcase(finding.system, self.system)
            and fnmatchcase(finding.rule, self.rule)
        )


def allowances(table: Table | None, known: Iterable[str]) -> list[Allowance]:
    """Return the entries of the table `lint`; `known` are additional codes of findings.

    Raises:
        UsageError: KG421 for all entries without a reason, with an unknown code, or with an unknown key.
    """
    entries = table.content.get("allow", []) if table else []
    if table is None or not entries:
        return []
    lines = table.text.splitlines()
    heads = [number for number, line in enumerate(lines, 1) if line.replace(" ", "").startswith(_HEAD)]
    places = [Place(str(table.file), line) for line in heads]
    if not isinstance(entries, list) or not all(isinstance(entry, dict) for entry in entries):
        raise _unusable(
            "`allow` of [lint] must be a list of tables", Place(str(table.file)), f"Write {_HEAD} for each."
        )
    places += [Place(str(table.file))] * (len(entries) - len(places))
    codes = {*known, *LINT_CODES}
    judged = [_allowance(entry, place, codes, lines) for entry, place in zip(entries, places, strict=False)]
    wrong = [fault for one in judged if not isinstance(one, Allowance) for fault in one]
    if wrong:
        (message, place, hint), *others = wrong
        more = "".join(f"; line {where.line}: {text}" for text, where, _ in others)
        raise _unusable(message + more, place, hint)
    return [one for one in judged if isinstance(one, Allowance)]


def _allowance(
    entry: Mapping[str, Any], place: Place, codes: set[str], lines: Sequence[str]
) -> Allowance | list[_Fault]:
    """Return an entry, or all its errors; `lines` are those of the file."""
    faults: list[_Fault] = []
    for key, value in entry.items():
        here = _line_of(key, place, lines)
        if key not in _KEYS:
            hint = did_you_mean(key, _KEYS) or f"The keys are {', '.join(_KEYS)}."
            faults.append((f"`{key}` is not a key of [[lint.allow]]", here, hint))
        elif not isinstance(value, str) or not value.strip():
            faults.append((f"`{key}` in [[lint.allow]] must be a string, not {value!r}", here, None))
    code = entry.get("code", "")
    if isinstance(code, str) and code not in codes and (code.strip() or "code" not in entry):
        message = f"`{code}` is not a code of a finding" if code else "this entry has no code"
        faults.append((message, _line_of("code", place, lines), did_you_mean(code, codes)))
    if "reason" not in entry and code:
        message = f"the entry for {code} has no reason"
        faults.append((message, place, 'Add `reason = "why it is right as it is"`.'))
    globs = {key: entry[key] for key in _GLOBS if key in entry}
    return faults or Allowance(code, entry["reason"].strip(), place, **globs)


def _line_of(key: str, place: Place, lines: Sequence[str]) -> Place:
    """Return the place of a key in the entry that begins at `place`; the entry's own if the key is not found."""
    for number in range(place.line or len(lines), len(lines)):
        text = lines[number].strip()
        if text.startswith("["):
            break
        if text.partition("=")[0].strip(" \t'\"") == key:
            return Place(place.path, number + 1)
    return place


def _unusable(message: str, place: Place, hint: str | None = None) -> UsageError:
    return UsageError("KG421", message, place=place, hint=hint)


class Comments:
    """Comments that allow a finding, read from the source files.

    `roots` are the folders of the sources by name. `without_reason` collects the comments without a reason, which allow
    nothing.
    """

    def __init__(self, roots: Mapping[str, str]) -> None:
        self._lines = Lines(roots)
        self.without_reason: dict[Place, str] = {}

    def allow(self, finding: Finding) -> bool:
        """Return whether a comment on the finding's line, or on a line of its own above, names its code."""
        place = finding.place
        if place is None or place.line is None:
            return False
        here, above = (self._lines.at(place, number) for number in (place.line, place.line - 1))
        return (here is not None and self._names(here, finding.code, place, place.line)) or (
            above is not None and _alone(above) and self._names(above, finding.code, place, place.line - 1)
        )

    def _names(self, line: str, code: str, place: Evidence, number: int) -> bool:
        comments = [match for match in _COMMENT.finditer(line) if match["code"].upper() == code]
        for match in comments:
            if not match["reason"].strip(" -"):
                self.without_reason[Place(str(self._lines.file(place.repository, place.path)), number)] = code
        return any(match["reason"].strip(" -") for match in comments)


def _alone(line: str) -> bool:
    """Return whether a line contains only a comment."""
    match = _COMMENT.search(line)
    return match is not None and not line[: match.start()].strip() and not line[match.end() :].strip()


def allowed_by(entries: Sequence[Allowance], comments: Comments) -> Callable[[Finding], Allowance | bool]:
    """Return a function from a finding to the entry that allows it, True for a comment, False for neither."""

    def judge(finding: Finding) -> Allowance | bool:
        entry = next((one for one in entries if one.names(finding)), None)
        return entry if entry is not None else comments.allow(finding)

    return judge
