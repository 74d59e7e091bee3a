"""Parse a request: words to search for, and wishes expressed by the words.

A wish is a preference, unless the text uses the form of a filter: `subscribes LaserScan`, `for ROS 2`, `BSD licensed`.
"""

from __future__ import annotations

import re
from collections import defaultdict
from dataclasses import dataclass, replace
from functools import cache, lru_cache
from typing import TYPE_CHECKING, Final

from kg.search.words import content_terms, is_stop, joined, lexicon, phrase, stem, words

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping, Sequence
    from collections.abc import Set as AbstractSet

    from kg.search.names import Names


_ARTICLES: Final = frozenset(("a", "an", "the", "my", "your", "his", "her", "its", "our", "their", "some", "any"))
_GAP: Final = "..."
_WIDEST: Final = 3  # so many words can stand at a gap
_START: Final = 2  # words with one stem have so many first letters in common


@dataclass(frozen=True, slots=True)
class Meaning:
    """A wording in a need: the indices of its words, and the terms that it stands for, with their relative weights."""

    places: tuple[int, ...]
    terms: Mapping[tuple[str, ...], float]


@dataclass(frozen=True, slots=True)
class _Pattern:
    """The stems of a wording, cut at its gaps, and its terms with their places in the line."""

    parts: tuple[tuple[str, ...], ...]
    terms: Mapping[str, int]


def meanings(typed: Sequence[str]) -> list[Meaning]:
    """Return the wordings in a need, given as its words; one that is part of a longer wording does not count."""
    places = [place for place, word in enumerate(typed) if word not in _ARTICLES]
    stems = [stem(typed[place]) for place in places]
    found: dict[tuple[int, ...], dict[str, int]] = {}
    for at, place in enumerate(places):
        for start in {typed[place][:_START], stems[at][:_START]}:
            for pattern in _patterns(start).get(stems[at], ()):
                if matched := _matched(pattern.parts, stems, at):
                    own = found.setdefault(tuple(places[one] for one in matched), {})
                    own.update((term, min(rank, own.get(term, rank))) for term, rank in pattern.terms.items())
    sets = [frozenset(one) for one in found]
    return [
        Meaning(one, _term_weights(terms))
        for one, terms in sorted(found.items())
        if not any(other > frozenset(one) for other in sets)
    ]


def _term_weights(terms: Mapping[str, int]) -> dict[tuple[str, ...], float]:
    """Return the stems of terms with their weights: each term of a line has less than the one before it."""
    later = lexicon().weights["rank"]["later"]
    return {content_terms(term): later**rank for term, rank in sorted(terms.items(), key=lambda one: one[1])}


def _matched(parts: Sequence[tuple[str, ...]], stems: Sequence[str], at: int) -> list[int]:
    """Return the indices of the words of a wording that begins at an index; none if it does not."""
    matched: list[int] = []
    for part in parts:
        last = at + _WIDEST if matched else at
        begin = next((one for one in range(at, last + 1) if tuple(stems[one : one + len(part)]) == part), None)
        if begin is None:
            return []
        at = begin + len(part)
        matched += range(begin, at)
    return matched


@cache
def _by_start() -> Mapping[str, list[str]]:
    """Return the wordings by their first letters: only those that a need may contain are stemmed."""
    starts: defaultdict[str, list[str]] = defaultdict(list)
    for wording in lexicon().everyday:
        starts[wording.partition(" ")[0][:_START]].append(wording)
    return starts


@cache
def _patterns(start: str) -> Mapping[str, list[_Pattern]]:
    """Return the patterns of the wordings with these first letters, by their first stem."""
    patterns: defaultdict[str, list[_Pattern]] = defaultdict(list)
    for wording in _by_start().get(start, ()):
        parts = tuple(tuple(_stems(part)) for part in wording.split(_GAP))
        patterns[parts[0][0]].append(_Pattern(parts, lexicon().everyday[wording]))
    return patterns


def _stems(text: str) -> Iterator[str]:
    return (stem(word) for word in words(text) if word not in _ARTICLES)


_EXPLICIT: Final = re.compile(
    r"\b(?P<role>subscrib|publish|provid|offer|serv|call)\w*\s+(?:to\s+|a\s+|an\s+|the\s+)?"
    r"(?P<type>(?:[a-z]\w*/)?(?:msg/|srv/|action/)?[A-Z]\w*)"
)
_MORE: Final = re.compile(r"\s*(?:,|and|or)\s+(?:a\s+|an\s+)?(?P<type>(?:[a-z]\w*/)?(?:msg/|srv/|action/)?[A-Z]\w*)")
_ROLES: Final = {
    "subscrib": "subscribes",
    "publish": "publishes",
    "provid": "services",
    "offer": "services",
    "serv": "services",
    "call": "clients",
}
_ROS: Final = re.compile(r"\bros\s?(?P<version>[12])\b", re.IGNORECASE)
_DISTRIBUTIONS: Final = {
    **dict.fromkeys(("noetic", "melodic", "kinetic", "indigo"), "1"),
    **dict.fromkeys(("foxy", "galactic", "humble", "iron", "jazzy", "kilted", "rolling"), "2"),
}
_NAMES: Final = "|".join(_DISTRIBUTIONS)
# Names of distributions are English words too: `a rolling window` and `an iron bar` name no version.
_DISTRIBUTION: Final = re.compile(
    rf"\bros\s?[12]?\s+(?P<behind>{_NAMES})\b"
    rf"|\b(?:for|in|on|under|with)\s+(?P<last>{_NAMES})\b(?=\s*(?:$|[,;:.!?)]|and\b|or\b))"
    rf"|\b(?P<before>{_NAMES})\s+(?:distribution|distro|release)\b",
    re.IGNORECASE,
)
_LICENSED: Final = re.compile(
    r"\b(?P<one>[\w.+-]+)[- ]licen[sc]ed?\b|\blicen[sc]ed?\s+(?:under|as|with)\s+(?:the\s+)?(?P<two>[\w.+-]+)",
    re.IGNORECASE,
)
_IN, _OUT, _BOTH = "in", "out", "both"
_SIDES: Final = {_IN: ("subscribes",), _OUT: ("publishes",), _BOTH: ("subscribes", "publishes")}
_MOST: Final = 2000
"""Number of characters that are read: a request is a sentence or two, and the time is quadratic in the length."""
_LONGEST: Final = 6  # so many words has the longest phrase of the lexicon
_TOLD: Final = 3  # behind so many significant words, `for` begins an aside
_SHORT_NAME: Final = 2
_OF_EVERY: Final = ("ros", "msg", "msgs")  # names without information about a node


@dataclass(frozen=True, slots=True)
class Alternative:
    """Terms that together are an alternative for a wording, and the weight of it.

    A `loose` one is meant by an everyday wording. It counts less if many nodes have the word itself.
    """

    terms: tuple[str, ...]
    weight: float
    loose: bool = False


@dataclass(frozen=True, slots=True)
class Wording:
    """A word or phrase of the need, as typed, with all its alternatives; the first one is the phrase itself.

    An `aside` is not part of the task and has less weight. `near` contains the spellings searched for a word that no
    node has; a word that is `unknown` has none.
    """

    text: str
    alternatives: tuple[Alternative, ...]
    aside: bool = False
    unknown: bool = False
    near: tuple[str, ...] = ()

    @property
    def name(self) -> bool:
        """Whether it was typed like a name, with a capital."""
        return any(letter.isupper() for letter in self.text)

    @property
    def weight(self) -> float:
        """The weight of the wording."""
        return lexicon().weights["rank"]["aside"] if self.aside else 1.0


@dataclass(frozen=True, slots=True)
class Wish:
    """A feature that hits should have: any of `features`. A strict wish excludes all nodes without it.

    `kind` is subscribes, publishes, ..., hardware, function, capability, ros, license; `wording` contains its words.
    """

    kind: str
    features: tuple[str, ...]
    wording: str
    strict: bool = False


@dataclass(frozen=True, slots=True)
class Need:
    """A parsed need."""

    text: str
    wordings: tuple[Wording, ...]
    wishes: tuple[Wish, ...]

    @property
    def unknown(self) -> tuple[str, ...]:
        """The words of the need that no node has, as typed."""
        return tuple(one.text for one in self.wordings if one.unknown)


@dataclass(frozen=True, slots=True)
class _Token:
    stem: str
    word: str
    aside: bool = False
    whole: str | None = None
    """The stem of the name that contains it: influxdb, of InfluxDB."""
    typed: str = ""

    @property
    def name(self) -> bool:
        """Whether a grammatical word was typed as a name: CAN."""
        return self.typed.isupper() and len(self.typed) > _SHORT_NAME and self.word not in _OF_EVERY


def parse(text: str, names: Names) -> Need:
    """Parse a text into a need; `names` are those of the store. Never fails, and is deterministic."""
    strict, remaining = _strict(text[:_MOST], names)
    tokens = _weighed(remaining)
    wishes = [*strict, *_typed(tokens, names), *_hardware(tokens, names)]
    return Need(text, tuple(_wordings(tokens, names)), tuple(dict.fromkeys(wishes)))


def _strict(text: str, names: Names) -> tuple[list[Wish], str]:
    """Return the wishes in the form of filters, and the text without parts that are not words to search for."""
    wishes: list[Wish] = []
    for match in _EXPLICIT.finditer(text):
        kind, at = _ROLES[match["role"]], match
        while at is not None:
            features = names.types(kind, at["type"])
            if features:
                wishes.append(Wish(kind, features, at["type"], strict=True))
            at = _MORE.match(text, at.end())  # type: ignore[assignment]  # the loop ends with None
    wishes += _versions(text)
    for match in _LICENSED.finditer(text):
        name = match["one"] or match["two"]
        if features := names.licenses(name):
            wishes.append(Wish("license", features, name, strict=True))
            text = text.replace(match[0], " ")
    return wishes, _ROS.sub(" ", text)


def _versions(text: str) -> list[Wish]:
    """Return the wishes for a version of ROS; none if a text names both, for example a bridge between them."""
    versions = [(match["version"], match[0]) for match in _ROS.finditer(text)]
    for match in _DISTRIBUTION.finditer(text):
        name = match["behind"] or match["last"] or match["before"]
        versions.append((_DISTRIBUTIONS[name.lower()], name))
    if len({version for version, _ in versions}) > 1:
        return []
    return [Wish("ros", (f"ros:{version}",), wording, strict=True) for version, wording in versions]


@lru_cache(maxsize=1)
def _turns() -> dict[tuple[str, ...], str]:
    return {phrase(one): turn for turn, phrases in lexicon().asides.items() for one in phrases}


def _weighed(text: str) -> list[_Token]:
    """Return the tokens of a text, with asides marked; an aside ends with its clause."""
    result: list[_Token] = []
    for clause in re.split(r"[,;:]\s", text):
        tokens = [token for name in clause.split() for token in _tokens(name)]
        stems = tuple(token.stem for token in tokens)
        at, aside = 0, ""
        while at < len(tokens):
            turn, length = _turn(stems, at)
            if turn == "wanted" and aside == "unwanted":
                aside = ""
            elif not aside and (
                turn == "unwanted" or (turn == "purpose" and sum(not is_stop(one.word) for one in result) >= _TOLD)
            ):
                aside = turn
            result += [replace(token, aside=bool(aside)) for token in tokens[at : at + length]]
            at += length
    return result


def _tokens(name: str) -> list[_Token]:
    """Return the tokens between two spaces."""
    whole = next(iter(joined(name)), None)
    return [_Token(stem(word), word, whole=whole, typed=name.strip("\"'.,;:!?()")) for word in words(name)]


def _turn(stems: tuple[str, ...], at: int) -> tuple[str, int]:
    """Return what a phrase at an index begins (`[asides]` of the lexicon), if anything, and its number of words."""
    for length in range(_LONGEST, 0, -1):
        turn = _turns().get(stems[at : at + length])
        if turn is not None:
            return turn, min(length, len(stems) - at)
    return "", 1


@lru_cache(maxsize=1)
def _type_phrases() -> dict[tuple[str, ...], tuple[str, ...]]:
    return {phrase(one): types for one, types in lexicon().types.items()}


@lru_cache(maxsize=1)
def _cues() -> dict[tuple[str, ...], str]:
    return {phrase(one): side for side, phrases in lexicon().directions.items() for one in phrases}


def _matches(tokens: Sequence[_Token], phrases: dict[tuple[str, ...], object]) -> Iterator[tuple[int, int]]:
    """Yield begin and end of known phrases: the longest at each index, without overlaps."""
    begin = 0
    stems = tuple(token.stem for token in tokens)
    while begin < len(stems):
        for end in range(min(len(stems), begin + _LONGEST), begin, -1):
            if stems[begin:end] in phrases:
                yield begin, end
                begin = end
                break
        else:
            begin += 1


def _wordings(tokens: Sequence[_Token], names: Names) -> Iterator[Wording]:
    """Yield a wording for every significant word, once each, with what the phrases that contain it stand for.

    A phrase of insignificant words alone that stands for something is one wording: `where it is`.
    """
    seen: set[str] = set()
    present = {token.whole for token in tokens} | {token.stem for token in tokens}
    synonyms = list(_synonyms(tokens, names))
    everyday = meanings([token.word for token in tokens])
    for meaning in (*synonyms, *everyday):
        phrased = [tokens[place] for place in meaning.places]
        if meaning.terms and all(is_stop(one.word) and not one.name for one in phrased):
            alternatives = tuple(Alternative(one, weight) for one, weight in meaning.terms.items())
            yield Wording(" ".join(one.word for one in phrased), alternatives, phrased[0].aside)
    for at, token in enumerate(tokens):
        if token.stem not in seen and (not is_stop(token.word) or token.name):
            seen.add(token.stem)
            yield _wording(token, _others(at, synonyms, present), _others(at, everyday, present), names)


def _synonyms(tokens: Sequence[_Token], names: Names) -> Iterator[Meaning]:
    stems = tuple(token.stem for token in tokens)
    for begin, end in _matches(tokens, names.synonyms):  # type: ignore[arg-type]  # only the keys are looked at
        yield Meaning(tuple(range(begin, end)), dict.fromkeys(names.synonyms[stems[begin:end]], 1.0))


def _others(at: int, found: Sequence[Meaning], present: AbstractSet[str | None]) -> dict[tuple[str, ...], float]:
    """Return the terms of the phrases that contain the word at an index, except those that the need contains."""
    weights: dict[tuple[str, ...], float] = {}
    for terms in (one.terms for one in found if at in one.places):
        for term, weight in terms.items():
            if not present >= set(term):
                weights[term] = max(weight, weights.get(term, 0.0))
    return weights


def _wording(
    token: _Token, synonyms: Mapping[tuple[str, ...], float], everyday: Mapping[tuple[str, ...], float], names: Names
) -> Wording:
    rank = lexicon().weights["rank"]
    alternatives = [Alternative((token.stem,), 1.0)]
    if token.whole is not None:
        alternatives.append(Alternative((token.whole,), 1.0))
    unknown = not everyday and not any(names.describes_node(one.terms[0]) for one in alternatives)
    near = names.spellings(token.whole or token.stem) if unknown else ()
    alternatives += [Alternative((term,), rank["spelling"] * likeness) for term, likeness in near]
    alternatives += [Alternative(one, rank["synonym"] * weight) for one, weight in synonyms.items()]
    alternatives += [Alternative(one, rank["everyday"] * weight, loose=True) for one, weight in everyday.items()]
    spelled = tuple(term for term, _ in near)
    return Wording(token.typed if unknown else token.word, tuple(alternatives), token.aside, unknown, spelled)


def _typed(tokens: Sequence[_Token], names: Names) -> Iterator[Wish]:
    """Yield the wishes of words for message types, with the direction from the words around them."""
    phrases = _type_phrases()
    for begin, end in _matches(tokens, phrases):  # type: ignore[arg-type]  # only the keys are looked at
        if tokens[begin].aside:
            continue
        stems = tuple(token.stem for token in tokens[begin:end])
        wording = " ".join(token.word for token in tokens[begin:end])
        for kind in _SIDES.get(_side(tokens, begin, end), ()):
            features = tuple(feature for type_ in phrases[stems] for feature in names.types(kind, type_))
            if features:
                yield Wish(kind, features, wording)


def _side(tokens: Sequence[_Token], begin: int, end: int) -> str:
    """Return the direction of a phrase: from the word directly after it, else from the nearest word before it."""
    cues = _cues()
    if end < len(tokens) and tokens[end].word in {"as", "into", "to"}:
        return _IN
    for at in range(begin - 1, -1, -1):
        for length in (2, 1):
            side = cues.get(tuple(token.stem for token in tokens[max(0, at - length + 1) : at + 1]))
            if side is not None:
                return side
    return ""


def _hardware(tokens: Sequence[_Token], names: Names) -> Iterator[Wish]:
    """Yield the wishes of words for hardware.

    Words for functions and capabilities occur in the texts of nodes; measurements showed no effect of wishes for them.
    """
    for begin, end in _matches(tokens, names.concepts):  # type: ignore[arg-type]  # only the keys are looked at
        if tokens[begin].aside:
            continue
        wording = " ".join(token.word for token in tokens[begin:end])
        for feature in names.concepts[tuple(token.stem for token in tokens[begin:end])]:
            if feature.startswith("hardware:"):
                yield Wish("hardware", (feature,), wording)
