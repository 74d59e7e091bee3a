"""The tree of a rule made of blocks, as JSON by msgspec; the tags `block`, `test` and `term` give the type of a part.

Names of properties, classes and things of the vocabulary are texts as SPARQL writes them: `rnkg:publishes`, or an IRI
in angle brackets; a property may be a path. `id` names a block for faces; it means nothing.
"""

from __future__ import annotations

import re
from typing import Annotated, Final, Literal, TypeAlias

import msgspec

from kg.codes import SEVERITIES

FAMILY: Final = "mine"
"""The family of a rule whose name says none."""

_NUMBER: Final = r"^[+-]?([0-9]+|[0-9]*\.[0-9]+)([eE][+-]?[0-9]+)?$"
_VARIABLE: Final = r"^[^\W]\w*$"
_NAME: Final = r"^[a-z0-9][a-z0-9_-]*(/[a-z0-9][a-z0-9_-]*)+$"

_Variable: TypeAlias = Annotated[str, msgspec.Meta(pattern=_VARIABLE)]
_Line: TypeAlias = Annotated[str, msgspec.Meta(min_length=1, max_length=10_000)]


class _Part(msgspec.Struct, frozen=True, kw_only=True, omit_defaults=True, forbid_unknown_fields=True):
    pass


class Thing(_Part, frozen=True, tag_field="term", tag="thing"):
    """Something that the pattern finds, by the name that the rule gives it: a variable."""

    name: _Variable


class Name(_Part, frozen=True, tag_field="term", tag="name"):
    """A certain thing of the vocabulary or of the store."""

    name: _Line


class Text(_Part, frozen=True, tag_field="term", tag="text"):
    """A text, in a language, or of another datatype than texts have."""

    value: str
    language: str = ""
    datatype: str = ""


class Number(_Part, frozen=True, tag_field="term", tag="number"):
    """A number as SPARQL writes it: 1, 1.0 and 1e0 are kept apart."""

    value: Annotated[str, msgspec.Meta(pattern=_NUMBER)]


class Truth(_Part, frozen=True, tag_field="term", tag="truth"):
    """Yes or no."""

    value: bool


class Join(_Part, frozen=True, tag_field="term", tag="join"):
    """Texts one behind the other (CONCAT)."""

    parts: tuple[Value, ...]


class Of(_Part, frozen=True, tag_field="term", tag="of"):
    """A function of one value: its text, its text in lower case, its length, the rounded number."""

    function: Literal["STR", "LCASE", "UCASE", "STRLEN", "ABS", "ROUND"]
    of: Value


class Reckon(_Part, frozen=True, tag_field="term", tag="reckon"):
    """Arithmetic with two numbers."""

    operator: Literal["+", "-", "*", "/"]
    left: Value
    right: Value


class Formula(_Part, frozen=True, tag_field="term", tag="formula"):
    """A SPARQL expression without a block of its own."""

    text: _Line


Term: TypeAlias = Thing | Name | Text | Number | Truth
"""What a fact may have as subject or object."""
Value: TypeAlias = Thing | Name | Text | Number | Truth | Join | Of | Reckon | Formula


class Compare(_Part, frozen=True, tag_field="test", tag="compare"):
    """Two values compared."""

    operator: Literal["=", "!=", "<", "<=", ">", ">="]
    left: Value
    right: Value


class Match(_Part, frozen=True, tag_field="test", tag="match"):
    """A text that has another in it, begins or ends with it, or matches it as a regular expression."""

    how: Literal["CONTAINS", "STRSTARTS", "STRENDS", "REGEX"]
    value: Value
    text: Value


class Bound(_Part, frozen=True, tag_field="test", tag="known"):
    """Whether a variable of an optional part is bound."""

    name: _Variable


class Logic(_Part, frozen=True, tag_field="test", tag="logic"):
    """Two tests of which both, or at least one, must hold."""

    operator: Literal["and", "or"]
    left: Test
    right: Test


class Not(_Part, frozen=True, tag_field="test", tag="not"):
    """The opposite of a test."""

    of: Test


class RawTest(_Part, frozen=True, tag_field="test", tag="formula"):
    """A SPARQL test without a block of its own."""

    text: _Line


Test: TypeAlias = Compare | Match | Bound | Logic | Not | RawTest


class _Block(_Part, frozen=True, kw_only=True):
    id: str = ""


class Fact(_Block, frozen=True, kw_only=True, tag_field="block", tag="fact"):
    """A subject, a property, an object."""

    subject: Term
    property: _Line
    object: Term


class Is(_Block, frozen=True, kw_only=True, tag_field="block", tag="is"):
    """Something is of a class."""

    subject: Term
    kind: _Line


class Only(_Block, frozen=True, kw_only=True, tag_field="block", tag="only"):
    """Only where a test holds."""

    test: Test


class Let(_Block, frozen=True, kw_only=True, tag_field="block", tag="let"):
    """A value gets a name."""

    name: _Variable
    value: Value


class Absent(_Block, frozen=True, kw_only=True, tag_field="block", tag="absent"):
    """Nothing matches this."""

    when: tuple[Condition, ...]


class Present(_Block, frozen=True, kw_only=True, tag_field="block", tag="present"):
    """Something matches this."""

    when: tuple[Condition, ...]


class Perhaps(_Block, frozen=True, kw_only=True, tag_field="block", tag="perhaps"):
    """An optional part, bound if it matches."""

    when: tuple[Condition, ...]


class Either(_Block, frozen=True, kw_only=True, tag_field="block", tag="either"):
    """One of several patterns."""

    branches: Annotated[tuple[tuple[Condition, ...], ...], msgspec.Meta(min_length=2)]


class Other(_Block, frozen=True, kw_only=True, tag_field="block", tag="sparql"):
    """A part of a SPARQL pattern without a block of its own."""

    text: _Line


Condition: TypeAlias = Fact | Is | Only | Let | Absent | Present | Perhaps | Either | Other
Conclusion: TypeAlias = Fact | Is


class Rule(_Part, frozen=True):
    """A rule: where all of `when` holds, all of `then` does.

    `name` is family and name, `title` to `references` its documentation, `prefixes` are those beside the ones that
    every rule knows and `my:`, which stands for the terms of the rule's family.
    """

    version: Literal[1] = 1
    name: Annotated[str, msgspec.Meta(pattern=_NAME)] = f"{FAMILY}/rule"
    title: str = ""
    infers: str = ""
    why: str = ""
    mend: str = ""
    limits: str = ""
    references: str = ""
    since: Annotated[str, msgspec.Meta(pattern=r"^\S+$")] = "0.1"
    severity: str | None = None
    prefixes: dict[Annotated[str, msgspec.Meta(pattern=r"^[A-Za-z][\w-]*$|^$")], str] = {}
    when: tuple[Condition, ...] = ()
    then: tuple[Conclusion, ...] = ()

    def __post_init__(self) -> None:
        """Raise ValueError for an unknown severity, and for a namespace that is not an IRI."""
        if self.severity is not None and self.severity not in SEVERITIES:
            raise ValueError(f"`{self.severity}` is not a severity")
        for namespace in self.prefixes.values():
            if re.search(r"[\x00-\x20<>\"{}|^`\\]", namespace):
                raise ValueError(f"`{namespace}` is not a valid namespace")
