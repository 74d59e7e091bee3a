"""Examples of rules, read from the Markdown page next to a file of rules (docs/rule-examples.md has the format).

An example is data (`given`), what the rule infers from it (`expect`, `expect exactly`), what it does not
(`expect-not`), and what is in the proofs (`why`).

The headings and fenced blocks of a Markdown page, with their lines: as much of CommonMark as examples need.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Final

from pyoxigraph import RdfFormat, Triple, parse

from kg.errors import Place, RuleError
from kg.rules.authoring.spelling import spell_triple
from kg.similar import did_you_mean
from kg.syntax.names import PREFIXES

EXAMPLE_NAMESPACE: Final = "https://example.org/"
"""What the prefix `ex:` and the empty one stand for in examples."""

_KINDS: Final = ("given", "expect", "expect-not")
_FORMS: Final = ("turtle given", "turtle given with=FAMILY/NAME", "turtle expect", "turtle expect exactly")
_HINT: Final = f"Blocks of examples are {', '.join(f'`{form}`' for form in _FORMS)}, `turtle expect-not`, `text why`."
_BASIC: Final[Mapping[str, str]] = {"": EXAMPLE_NAMESPACE, "ex": EXAMPLE_NAMESPACE, **PREFIXES}
_PREAMBLE: Final = "".join(f"@prefix {prefix}: <{iri}> . " for prefix, iri in _BASIC.items())

_FENCE: Final = re.compile(r" {0,3}(?P<fence>`{3,}|~{3,})\s*(?P<info>[^`]*)")
_HEADING: Final = re.compile(r" {0,3}(?P<level>#{1,6})\s+(?P<title>.*?)\s*#*\s*")


@dataclass(frozen=True, slots=True)
class Heading:
    """A heading of a level from 1 to 6; lines count from one."""

    level: int
    title: str
    line: int


@dataclass(frozen=True, slots=True)
class Fence:
    """A fenced block: the words after the fence, and the content; `line` is that of the fence."""

    info: str
    text: str
    line: int
    closed: bool


def parts(text: str) -> Iterator[Heading | Fence]:
    """Yield the headings and fenced blocks of a page (CommonMark 0.31, sections 4.2 and 4.5)."""
    lines = text.splitlines()
    number = 0
    while number < len(lines):
        line = lines[number]
        number += 1
        if fence := _FENCE.fullmatch(line):
            end = _end(lines, number, fence["fence"])
            inner = "".join(f"{each}\n" for each in lines[number:end])
            yield Fence(" ".join(fence["info"].split()), inner, number, closed=end < len(lines))
            number = end + 1
        elif heading := _HEADING.fullmatch(line):
            yield Heading(len(heading["level"]), heading["title"], number)


def _end(lines: list[str], start: int, fence: str) -> int:
    """Return the index of the line that closes a block, or the number of lines."""
    closing = re.compile(rf" {{0,3}}{re.escape(fence[0])}{{{len(fence)},}}\s*")
    return next((index for index in range(start, len(lines)) if closing.fullmatch(lines[index])), len(lines))


@dataclass(frozen=True, slots=True)
class Expectation:
    """One block of expected triples: `kind` is expect, exactly or not; a blank node matches any term."""

    kind: str
    triples: tuple[Triple, ...]
    place: Place


@dataclass(frozen=True, slots=True)
class WhyLine:
    """One line that must be part of a line of a proof."""

    text: str
    place: Place


@dataclass(frozen=True, slots=True)
class Example:
    """One example; `others` are the rules that run with those of the file, each with the place that names it."""

    title: str
    place: Place
    given: tuple[Triple, ...]
    others: tuple[tuple[str, Place], ...]
    expectations: tuple[Expectation, ...]
    why: tuple[WhyLine, ...]
    prefixes: Mapping[str, str]

    @property
    def expected(self) -> tuple[Triple, ...]:
        """The triples that must be inferred."""
        return tuple(triple for each in self.expectations if each.kind != "not" for triple in each.triples)


def read_examples(path: Path) -> tuple[Example, ...]:
    """Return the examples of a page; raises as `parse_examples`, and KG221 for a file without any, or not readable."""
    try:
        examples = parse_examples(path.read_text("utf-8"), str(path))
    except (OSError, UnicodeDecodeError) as error:
        reason = getattr(error, "strerror", None) or error
        raise RuleError("KG221", f"the examples cannot be read: {reason}", place=Place(str(path))) from error
    if not examples:
        raise RuleError(
            "KG221", "the page has no example", place=Place(str(path), 1), hint="Begin one with `## TITLE`."
        )
    return examples


def parse_examples(text: str, path: str) -> tuple[Example, ...]:
    """Return the examples of a page given as text.

    Raises RuleError: KG221 with the line of a block that does not belong to an example, or does not parse.
    """
    return tuple(one.finished() for one in _drafts(text, path))


@dataclass(slots=True)
class _Draft:
    """An example while its blocks are read."""

    title: str
    place: Place
    given: list[Triple] = field(default_factory=list)
    others: dict[str, Place] = field(default_factory=dict)
    expectations: list[Expectation] = field(default_factory=list)
    why: list[WhyLine] = field(default_factory=list)
    prefixes: dict[str, str] = field(default_factory=lambda: dict(_BASIC))

    def add(self, fence: Fence, place: Place) -> None:
        """Take a block; those for readers are left alone."""
        kind, words = _kind(fence, place)
        if kind == "why":
            numbered = enumerate(fence.text.splitlines(), fence.line + 1)
            texts = ((number, " ".join(line.split())) for number, line in numbered)
            self.why += (WhyLine(text, Place(place.path, number)) for number, text in texts if text)
        elif kind == "given":
            self.given += self._triples(fence, place)
            for word in words:
                key, sign, names = word.partition("=")
                if key != "with" or not sign or not all(names.split(",")):
                    raise RuleError("KG221", f"`{word}` has no given data", place=place, hint=_HINT)
                self.others.update(dict.fromkeys(names.split(","), place))
        elif kind:
            self._expect(kind, words, tuple(self._triples(fence, place)), place)

    def _expect(self, kind: str, words: list[str], triples: tuple[Triple, ...], place: Place) -> None:
        exactly = kind == "expect" and words == ["exactly"]
        if words and not exactly:
            raise RuleError("KG221", f"`{' '.join(words)}` does not mention {kind}", place=place, hint=_HINT)
        if not triples and not exactly:
            hint = "Write triples, or `turtle expect exactly` for an example in which nothing is inferred."
            raise RuleError("KG221", f"the block {kind} has no triples", place=place, hint=hint)
        self.expectations.append(Expectation("exactly" if exactly else kind.removeprefix("expect-"), triples, place))

    def _triples(self, fence: Fence, place: Place) -> Iterator[Triple]:
        declared = "".join(f"@prefix {name}: <{iri}> . " for name, iri in self.prefixes.items() if name not in _BASIC)
        preamble = _PREAMBLE + declared
        try:
            parsed = parse(preamble + fence.text, RdfFormat.TURTLE, base_iri=EXAMPLE_NAMESPACE)
            yield from (quad.triple for quad in parsed)
        except SyntaxError as error:
            raise _turtle_error(error, fence, place, len(preamble)) from None
        self.prefixes.update(parsed.prefixes)

    def finished(self) -> Example:
        """Return the example if it has anything to test."""
        if not self.expectations and not self.why:
            hint = "Add a block `turtle expect`, `turtle expect exactly` or `turtle expect-not` below the heading."
            raise RuleError("KG221", f"the example `{self.title}` expects nothing", place=self.place, hint=hint)
        given = set(self.given)
        for each in self.expectations:
            stated = [triple for triple in each.triples if triple in given and each.kind != "not"]
            if stated:
                triple = spell_triple(stated[0], self.prefixes)
                message = f"`{triple}` is given and expected; given facts are not inferred"
                raise RuleError("KG221", message, place=each.place, hint="Take it out of one of the two blocks.")
        return Example(
            self.title,
            self.place,
            tuple(dict.fromkeys(self.given)),
            tuple(self.others.items()),
            tuple(self.expectations),
            tuple(self.why),
            self.prefixes,
        )


def _drafts(text: str, path: str) -> Iterator[_Draft]:
    """Yield the parts below headings of the second level that have blocks of examples."""
    draft: _Draft | None = None
    for part in parts(text):
        place = Place(path, part.line)
        if isinstance(part, Heading):
            if part.level > 2:  # noqa: PLR2004 - deeper headings stand inside an example
                continue
            if draft and _has_blocks(draft):
                yield draft
            draft = _Draft(part.title, place) if part.level == 2 else None  # noqa: PLR2004 - examples have `##`
        elif not part.closed:
            raise RuleError("KG221", "the block is not closed", place=place, hint="End it with a line of backticks.")
        elif draft:
            draft.add(part, place)
        elif _kind(part, place)[0]:
            raise RuleError(
                "KG221",
                "the block is not below the heading of an example",
                place=place,
                hint="Begin it with `## TITLE`.",
            )
    if draft and _has_blocks(draft):
        yield draft


def _has_blocks(draft: _Draft) -> bool:
    """Return whether a heading has any block of an example; prose may have headings too."""
    return bool(draft.given or draft.others or draft.expectations or draft.why)


def _kind(fence: Fence, place: Place) -> tuple[str, list[str]]:
    """Return the kind of a block, empty if it is only for readers, and the words after the kind."""
    language, *words = fence.info.split() or [""]
    if language not in {"turtle", "text", "ttl"} or not words:
        return "", []
    kind, *rest = words
    kinds = ("why",) if language == "text" else _KINDS
    if kind not in kinds:
        near = did_you_mean(kind, kinds)
        hint = f"{near} {_HINT}" if near else _HINT
        raise RuleError("KG221", f"unknown block `{language} {kind}` in examples", place=place, hint=hint)
    return kind, rest


def _turtle_error(error: SyntaxError, fence: Fence, place: Place, before: int) -> RuleError:
    """Translate the engine's error; its first line begins behind the `before` signs of prefixes."""
    line = error.lineno or 1
    column = (error.offset or 1) - (before if line == 1 else 0)
    message = error.msg.partition(": ")[2] or error.msg
    where = Place(place.path, fence.line + line, column if column > 0 else None)
    return RuleError("KG221", f"this is not Turtle: {message}", place=where, hint="Correct the block there.")
