"""Findings of checks, as values and as remarks at their lines; the input of checks, and names in the text of a rule."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Final

from kg.errors import Fix, Place, RuleError
from kg.render.sarif import Remark, Spot
from kg.syntax.lexer import Kind, Token, iri_of, is_name, normalise, tokens
from kg.syntax.position import place_at, place_of

if TYPE_CHECKING:
    from collections.abc import Iterator

    from pyoxigraph import Triple

    from kg.rules.checks.firing import StoreOf
    from kg.rules.files import RuleFile, RuleSet
    from kg.rules.form import Rule

SECONDS: Final = 5.0
"""How long a store may be asked about one rule, where nothing else is said."""


@dataclass(frozen=True, slots=True)
class Finding:
    """Something wrong with a rule: `rule` is the name of its file, `place` has the line and column.

    `lacks` names what its documentation lacks, as `kg.rules.blocks.tree.Rule` does: `title`, `infers`, `why`, `since`.
    `fixes` are alternative edits that do what the hint says.
    """

    code: str
    severity: str
    rule: str
    message: str
    place: Place
    hint: str | None = None
    lacks: tuple[str, ...] = ()
    fixes: tuple[Fix, ...] = ()

    @property
    def error(self) -> RuleError:
        """The finding as an error, which is shown alike."""
        return RuleError(self.code, self.message, place=self.place, hint=self.hint)


@dataclass(frozen=True, slots=True)
class Context:
    """Input of the checks of a file.

    `rules` are all in force, the file itself among them, and `cut` the same cut to the schema, where that was done;
    `terms` what ontologies and data define or use, as IRIs; `read` the IRIs that stored queries mention; `schema` the
    axioms that rules about any schema are cut to; `empty` is a store without data. `store` is None when there is none;
    what it is asked about one rule may take `seconds`, None being without end.
    """

    rules: RuleSet
    terms: frozenset[str] = frozenset()
    read: frozenset[str] = frozenset()
    store: StoreOf | None = None
    empty: StoreOf | None = None
    schema: tuple[Triple, ...] = ()
    seconds: float | None = SECONDS
    cut: tuple[Rule, ...] = ()


def at_rule(file: RuleFile) -> Place:
    """Return the place of the first rule of a file, or its first line."""
    return file.rules[0].place if file.rules else place_of(file.text, 1, 1, str(file.path))


def at_offset(file: RuleFile, offset: int) -> Place:
    """Return the place of a character of a file."""
    return place_at(file.text, offset, str(file.path))


def from_error(error: RuleError, name: str, place: Place) -> Finding:
    """Return the finding that an error is, raised while a file was read or rules were put in order."""
    return Finding(error.code, "error", name, error.message, error.place or place, error.hint, fixes=error.fixes)


def as_object(finding: Finding) -> dict[str, object]:
    """Return a finding as plain values: the keys of `Finding`, its place as `file`, `line` and `column`."""
    return {
        "code": finding.code,
        "severity": finding.severity,
        "rule": finding.rule,
        "message": finding.message,
        "file": finding.place.path,
        "line": finding.place.line,
        "column": finding.place.column,
        "hint": finding.hint,
    }


def remark(finding: Finding, root: Path | None = None) -> Remark:
    """Return a finding as a remark at its line, the file as it was named.

    With a `root`, for SARIF, files below it are named relative to it and others by a URI; the hint is in the message.
    """
    place, uri, text = finding.place, finding.place.path, finding.message
    if root is not None:
        path = Path(uri).absolute()
        uri = path.relative_to(root).as_posix() if path.is_relative_to(root) else path.as_uri()
        text = f"{text}. {finding.hint}" if finding.hint else text
    return Remark(finding.code, finding.severity, text, Spot(uri, place.line, place.column))


_DECLARING: Final = {"PREFIX": 2, "@PREFIX": 2, "BASE": 1, "@BASE": 1, "IMPORTS": 1, "VERSION": 1, "@VERSION": 1}
"""How many tokens belong to a declaration that begins with these."""


def names(file: RuleFile) -> Iterator[tuple[str, Token]]:
    """Yield each name of a file as an IRI with its token; declarations of prefixes are left out.

    So are the names inside the queries of SHACL rules, which are strings to Turtle.
    """
    declaring = 0
    for token in tokens(normalise(file.text)):
        if token.kind in {Kind.WORD, Kind.TAG} and token.text.upper() in _DECLARING:
            declaring = _DECLARING[token.text.upper()]
        elif declaring:
            declaring -= 1
        elif is_name(token) and (iri := iri_of(token, file.prefixes)) is not None:
            yield iri, token


def place_of_name(file: RuleFile, iri: str) -> Place:
    """Return where a file first names an IRI, else the place of its first rule."""
    return next((at_offset(file, token.start) for name, token in names(file) if name == iri), at_rule(file))


def variables(file: RuleFile) -> Iterator[Token]:
    """Yield the variables of a file in the order of the text; in Turtle there are none."""
    if file.notation != ".ttl":
        yield from (token for token in tokens(normalise(file.text)) if token.kind is Kind.VARIABLE)
