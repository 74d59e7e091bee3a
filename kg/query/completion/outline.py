"""Outline of a query, complete or broken: its triple patterns, its variables, and the tokens expected after it.

An unfinished query seldom parses. So this parser reads tokens one by one and never fails: it skips unexpected ones and
resynchronizes at a dot, a keyword or a bracket.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, field
from enum import Enum, auto
from typing import Final, NamedTuple

from kg.syntax.lexer import Kind, Token
from kg.syntax.names import PREFIXES

TYPE: Final = PREFIXES["rdf"] + "type"


class Slot(Enum):
    """The kind of token expected at a position."""

    BEGIN = auto()
    """A declaration, or the form of the query."""
    PREFIX = auto()
    """The name of a prefix after PREFIX."""
    NAMESPACE = auto()
    """The IRI of a prefix or of BASE."""
    PROJECTION = auto()
    DATASET = auto()
    """The name of a graph after FROM."""
    CLAUSE = auto()
    """A brace, or WHERE or FROM before it."""
    TEMPLATE = auto()
    """The brace of a template."""
    OPENING = auto()
    """A bracket, after OPTIONAL, BIND and similar keywords."""
    CONSTRAINT = auto()
    """The constraint of FILTER."""
    GRAPH = auto()
    """The name of a graph after GRAPH."""
    SUBJECT = auto()
    PREDICATE = auto()
    OBJECT = auto()
    AFTER = auto()
    """After a triple: punctuation, or a keyword."""
    EXPRESSION = auto()
    NEW = auto()
    """A new variable, after AS."""
    COLUMNS = auto()
    """The variables of VALUES."""
    DATA = auto()
    """A value in VALUES."""
    MODIFIER = auto()
    """After the pattern: GROUP BY, ORDER BY, LIMIT, ..."""
    ORDER = auto()
    """After GROUP BY, ORDER BY, HAVING."""
    NUMBER = auto()


class Role(Enum):
    """The content of a bracket."""

    QUERY = auto()
    GROUP = auto()
    TEMPLATE = auto()
    EXPRESSION = auto()
    LIST = auto()
    BLANK = auto()
    PATH = auto()
    DATA = auto()


class Step(NamedTuple):
    """A property of a path; `iri` is None for a variable, `inverse` is whether it follows `^`."""

    iri: str | None
    inverse: bool


class Pattern(NamedTuple):
    """A triple pattern; terms are `?name`, an IRI without brackets, `_:label`, or the text of a literal.

    `path` contains the steps from subject to object. `group` is the number of its group, 0 in templates. `start` is the
    start of its subject, `end` the end of its object.
    """

    subject: str
    path: tuple[Step, ...]
    object: str
    group: int
    start: int
    end: int


class Use(NamedTuple):
    """An occurrence of a variable; `group` is the number of its group, `within` that of its expression or 0."""

    name: str
    slot: Slot
    group: int
    within: int
    token: Token


@dataclass(slots=True)
class Frame:
    """An open bracket, and the state of parsing its content."""

    role: Role
    slot: Slot
    group: int = 0
    within: int = 0
    subject: str = ""
    start: int = 0
    steps: list[Step] = field(default_factory=list)
    inverse: bool = False
    columns: list[str] = field(default_factory=list)
    column: int = 0
    closes: str = ""


@dataclass(slots=True)
class Outline:
    """Content of a query; `frame` is the innermost open bracket, `inside` maps a group to the one that contains it."""

    patterns: list[Pattern] = field(default_factory=list)
    uses: list[Use] = field(default_factory=list)
    prefixes: dict[str, str] = field(default_factory=dict)
    inside: dict[int, int] = field(default_factory=dict)
    words: set[str] = field(default_factory=set)
    frames: list[Frame] = field(default_factory=lambda: [Frame(Role.QUERY, Slot.BEGIN)])
    previous: Token | None = None
    numbers: int = 0

    @property
    def frame(self) -> Frame:
        """The innermost open bracket."""
        return self.frames[-1]

    def iri(self, token: Token) -> str:
        """Return the IRI of a token, or the name itself if its prefix is unknown."""
        if token.kind is Kind.IRI:
            return token.text[1:-1]
        prefix, _, local = token.text.partition(":")
        namespace = self.prefixes.get(prefix, PREFIXES.get(prefix))
        return token.text if namespace is None else namespace + local.replace("\\", "")

    def term(self, token: Token) -> str:
        """Return the term of a token as in patterns."""
        if token.kind is Kind.VARIABLE:
            return "?" + token.text[1:]
        return self.iri(token) if token.kind in {Kind.IRI, Kind.NAME} else token.text

    def number(self) -> int:
        """Return an unused number."""
        self.numbers += 1
        return self.numbers


def outline(lexed: Iterable[Token], before: Outline | None = None) -> Outline:
    """Return the outline of tokens, which extends `before`, that of the tokens before."""
    result = before or Outline()
    for token in lexed:
        frame = result.frame
        word = token.text.lower() if token.kind is Kind.WORD else ""
        if token.kind is Kind.VARIABLE:
            result.uses.append(Use(token.text[1:], frame.slot, frame.group, frame.within, token))
        if token.kind is Kind.SIGN:
            _sign(result, frame, token)
        elif frame.role is Role.EXPRESSION:
            result.words.add(word)
            frame.slot = Slot.NEW if word == "as" else Slot.EXPRESSION
        elif word and _keyword(result, frame, word):
            result.words.add(word)
        else:
            _other_token(result, frame, token)
        result.previous = token
    return result


_KEYWORDS: Final = {
    "select": Slot.PROJECTION,
    "describe": Slot.PROJECTION,
    "construct": Slot.TEMPLATE,
    "ask": Slot.CLAUSE,
    "where": Slot.CLAUSE,
    "from": Slot.DATASET,
    "prefix": Slot.PREFIX,
    "base": Slot.NAMESPACE,
    "group": Slot.MODIFIER,
    "order": Slot.MODIFIER,
    "by": Slot.ORDER,
    "having": Slot.ORDER,
    "limit": Slot.NUMBER,
    "offset": Slot.NUMBER,
    "values": Slot.COLUMNS,
    "filter": Slot.CONSTRAINT,
    "bind": Slot.OPENING,
    "optional": Slot.OPENING,
    "minus": Slot.OPENING,
    "union": Slot.OPENING,
    "graph": Slot.GRAPH,
    "service": Slot.GRAPH,
    "insert": Slot.TEMPLATE,
    "delete": Slot.TEMPLATE,
}
_WITHOUT_SLOT: Final = frozenset({"exists", "not", "distinct", "reduced", "named", "silent", "asc", "desc", "data"})


def _keyword(result: Outline, frame: Frame, word: str) -> bool:
    """Process a keyword; False if the word is not a keyword here."""
    if word in _WITHOUT_SLOT:
        return True
    if word not in _KEYWORDS or frame.role in {Role.LIST, Role.DATA}:
        return False
    while frame.role in {Role.BLANK, Role.PATH}:
        result.frames.pop()
        frame = result.frame
    frame.slot = _KEYWORDS[word]
    if word == "values":
        frame.columns = []
    return True


_IN_ORDER: Final = frozenset(
    {
        Slot.BEGIN,
        Slot.PROJECTION,
        Slot.DATASET,
        Slot.CLAUSE,
        Slot.TEMPLATE,
        Slot.OPENING,
        Slot.CONSTRAINT,
        Slot.MODIFIER,
        Slot.ORDER,
    }
)
"""Slots that may contain several tokens: a token does not change them."""


def _other_token(result: Outline, frame: Frame, token: Token) -> None:
    """Process a token that is neither a sign, a keyword, nor a part of an expression."""
    match frame.slot:
        case Slot.PREFIX:
            frame.subject = token.text.partition(":")[0]
            frame.slot = Slot.NAMESPACE
        case Slot.NAMESPACE:
            if token.kind is Kind.IRI and result.previous is not None and result.previous.kind is Kind.NAME:
                result.prefixes[frame.subject] = token.text[1:-1]
            frame.slot = Slot.BEGIN
        case Slot.GRAPH:
            frame.slot = Slot.OPENING
        case Slot.COLUMNS:
            frame.columns.append("?" + token.text[1:])
        case Slot.DATA:
            frame.column += 1
        case Slot.NUMBER:
            frame.slot = Slot.MODIFIER
        case slot if slot not in _IN_ORDER:
            _pattern_term(result, frame, token)


def _pattern_term(result: Outline, frame: Frame, token: Token) -> None:
    if frame.role is Role.LIST or token.kind is Kind.TAG:
        return
    if frame.slot is Slot.PREDICATE:
        kind_of = token.kind is Kind.WORD and token.text == "a"
        named = token.kind in {Kind.IRI, Kind.NAME}
        iri = TYPE if kind_of else result.iri(token) if named else None
        frame.steps.append(Step(iri, frame.inverse))
        frame.inverse = False
        frame.slot = Slot.OBJECT
    elif frame.slot is Slot.OBJECT and frame.role is not Role.PATH:
        _object(result, frame, result.term(token), token.end)
    elif frame.role is not Role.PATH:
        frame.subject, frame.start = result.term(token), token.start
        frame.steps = []
        frame.slot = Slot.PREDICATE


def _object(result: Outline, frame: Frame, term: str, end: int) -> None:
    if frame.subject:
        result.patterns.append(Pattern(frame.subject, tuple(frame.steps), term, frame.group, frame.start, end))
    frame.slot = Slot.AFTER


def _sign(result: Outline, frame: Frame, token: Token) -> None:
    sign = token.text
    if sign in {"{", "(", "[", "{|", "<<", "<<("}:
        _open(result, frame, token)
    elif sign in {"}", ")", "]", "|}", ">>", ")>>"}:
        _close(result, sign, token.end)
    elif frame.role is Role.EXPRESSION:
        frame.slot = Slot.EXPRESSION
    elif frame.slot in {Slot.SUBJECT, Slot.PREDICATE, Slot.OBJECT, Slot.AFTER}:
        _punctuation(frame, sign)


def _punctuation(frame: Frame, sign: str) -> None:
    if sign == "." and frame.role in {Role.GROUP, Role.TEMPLATE}:
        frame.slot = Slot.SUBJECT
    elif sign == ";":
        frame.slot = Slot.PREDICATE
        frame.steps = []
    elif sign == "," and frame.slot is Slot.AFTER:
        frame.slot = Slot.OBJECT
    elif sign == "^" and frame.slot is Slot.PREDICATE:
        frame.inverse = True
    elif sign in {"/", "|"} and frame.slot is Slot.OBJECT and frame.steps:
        if sign == "|":
            frame.steps.pop()
        frame.slot = Slot.PREDICATE


_IN_PATTERNS: Final = frozenset({Slot.SUBJECT, Slot.AFTER, Slot.OBJECT, Slot.PREDICATE})


def _open(result: Outline, frame: Frame, token: Token) -> None:
    if token.text == "{":
        _open_brace(result, frame)
    elif token.text == "[":
        label = f"_:{result.number()}"
        if frame.slot is Slot.OBJECT:
            _object(result, frame, label, token.end)
        elif frame.slot in _IN_PATTERNS:
            frame.subject, frame.start, frame.steps = label, token.start, []
            frame.slot = Slot.PREDICATE
        result.frames.append(
            Frame(Role.BLANK, Slot.PREDICATE, frame.group, subject=label, start=token.start, closes="]")
        )
    elif token.text in {"<<", "<<("}:
        result.frames.append(Frame(Role.LIST, Slot.OBJECT, frame.group, closes=")>>"[token.text == "<<" :]))
    elif token.text == "{|":
        label = f"_:{result.number()}"
        result.frames.append(
            Frame(Role.BLANK, Slot.PREDICATE, frame.group, subject=label, start=token.start, closes="|}")
        )
    else:
        _open_parenthesis(result, frame)


def _open_brace(result: Outline, frame: Frame) -> None:
    if frame.slot is Slot.COLUMNS:
        result.frames.append(Frame(Role.DATA, Slot.DATA, frame.group, columns=frame.columns, closes="}"))
        return
    role = Role.TEMPLATE if frame.slot is Slot.TEMPLATE else Role.GROUP
    number = result.number() if role is Role.GROUP else 0
    result.inside[number] = frame.group
    result.frames.append(Frame(role, Slot.SUBJECT, number, closes="}"))


def _open_parenthesis(result: Outline, frame: Frame) -> None:
    if frame.role is Role.DATA:
        frame.column = 0
    elif frame.slot is Slot.COLUMNS:
        return
    elif frame.slot is Slot.PREDICATE:
        result.frames.append(Frame(Role.PATH, Slot.PREDICATE, frame.group, subject=frame.subject, closes=")"))
    elif frame.slot in _IN_PATTERNS:
        result.frames.append(Frame(Role.LIST, Slot.OBJECT, frame.group, closes=")"))
    else:
        within = frame.within or result.number()
        result.frames.append(Frame(Role.EXPRESSION, Slot.EXPRESSION, frame.group, within, closes=")"))


def _close(result: Outline, sign: str, end: int) -> None:
    """Close the innermost frame that `sign` closes; a brace also closes the open frames in it."""
    if result.frame.role is Role.DATA and sign == ")":
        return
    depth = len(result.frames) - 1
    while depth > 0 and result.frames[depth].closes != sign:
        if result.frames[depth].closes == "}":
            return
        depth -= 1
    if depth == 0:
        return
    closed = result.frames[depth]
    del result.frames[depth:]
    _after_bracket(result, result.frame, closed, end)


def _after_bracket(result: Outline, frame: Frame, closed: Frame, end: int) -> None:
    """Set the slot of `frame` after the bracket `closed` in it."""
    if closed.role is Role.TEMPLATE:
        frame.slot = Slot.CLAUSE
    elif closed.role is Role.PATH:
        frame.steps += closed.steps
        frame.slot = Slot.OBJECT
    elif closed.role is Role.BLANK:
        frame.slot = frame.slot if frame.slot in {Slot.AFTER, Slot.PREDICATE} else Slot.AFTER
    elif closed.role is Role.LIST:
        if frame.slot is Slot.OBJECT:
            _object(result, frame, f"_:{result.number()}", end)
        elif frame.slot in _IN_PATTERNS:
            frame.subject, frame.slot = f"_:{result.number()}", Slot.PREDICATE
    elif frame.role is Role.EXPRESSION:
        frame.slot = Slot.EXPRESSION
    elif closed.role in {Role.GROUP, Role.DATA} and frame.slot in _OF_QUERIES:
        frame.slot = Slot.MODIFIER if frame.role is Role.QUERY or closed.role is Role.GROUP else Slot.SUBJECT
    elif frame.slot in {Slot.CONSTRAINT, Slot.OPENING}:
        frame.slot = Slot.SUBJECT


_OF_QUERIES: Final = frozenset({Slot.BEGIN, Slot.CLAUSE, Slot.PROJECTION, Slot.DATASET, Slot.COLUMNS, Slot.MODIFIER})
