"""Table 9: comparison of the graph with the code, by samples of calls and of facts.

Are calls in the code in the graph, and do the lines of facts contain them? Calls come from an independent reader
(`sites`): regular expressions over text without comments and strings. It knows nothing of types, templates or
reachability. So some of its calls are not of ROS, and it misses interfaces that only types reveal, such as members
created in a constructor's initialiser list.

Both samples are stratified by kind; the last row weighs kinds by their number.
"""

from __future__ import annotations

import os
import random
import re
from bisect import bisect_right
from collections import Counter, defaultdict
from dataclasses import dataclass, field, replace
from pathlib import Path, PurePosixPath
from typing import TYPE_CHECKING, Final

from kg.corpus.reading import digest
from kg.evaluate.completeness import share
from kg.evaluate.sheet import STATED, Fact, Facts, SourceLines, drawn, stated
from kg.evaluate.tables import Cell, Share, Table, shares_of, weighed, with_paper
from kg.graph.iris import is_source_graph
from kg.graph.reading.nodes import node_records
from kg.query.rows import rows
from kg.rules.selecting import columns_of

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Mapping, Sequence

    from kg.store.snapshot import EmbeddedSnapshot

_CALLS: Final = "calls that the graph has"
_FACTS: Final = "facts that their line holds"
_ALL: Final = "all, weighed by number"
_LARGEST: Final = 4_000_000
_TEST: Final = re.compile(
    r"(?:^|/)(?:[gm]?tests?|[^/]*_tests?|gtest[^/]*)/|(?:^|/)(?:test_[^/]*|[^/]*_?[tT]ests?)\.\w+$"
)
"""Paths of test files."""

_REPOSITORY: Final = "SELECT ?name { GRAPH %s { ?repository a rnkg:Repository ; rnkg:name ?name } }"
_FILES: Final = "SELECT ?path ?digest { GRAPH %s { ?file rnkg:path ?path ; rnkg:digest ?digest } }"
_FOLDERS: Final = "SELECT ?folder { GRAPH %s { ?package a rnkg:Package ; rnkg:folder ?folder } }"

CPP: Final = frozenset({".c", ".cc", ".cpp", ".cxx", ".c++", ".h", ".hh", ".hpp", ".hxx", ".ipp"})
PYTHON: Final = frozenset({".py"})
_CPP_WORDS: Final = re.compile(
    r'//[^\n]*|/\*.*?(?:\*/|\Z)|\bu?8?[LUR]*R"([^()\\\s"]{0,16})\(.*?\)\1"'
    r'|"(?:[^"\\\n]|\\.)*"|\'(?:[^\'\\\n]|\\.){1,8}\'',
    re.DOTALL,
)
_PYTHON_WORDS: Final = re.compile(
    r'#[^\n]*|"""(?:[^\\]|\\.)*?(?:"""|\Z)|\'\'\'(?:[^\\]|\\.)*?(?:\'\'\'|\Z)|"(?:[^"\\\n]|\\.)*"|\'(?:[^\'\\\n]|\\.)*\'',
    re.DOTALL,
)
_DEFINE: Final = re.compile(
    r"^[ \t]*#[ \t]*(?:define|if|elif|error|warning|pragma)\b(?:[^\n]*\\\n)*[^\n]*", re.MULTILINE
)
_KEPT: Final = re.compile(r"[^\n]")
_OPENS: Final = r"\s{0,8}[<(]"
_NEW: Final = r"\b(?:new\s{1,4}|make_(?:shared|unique)\s{0,4}<\s{0,4})(?:\w+::){0,3}"
_CPP_CALLS: Final = {
    "publishes": (r"advertise(?:Camera)?", r"create_(?:camera_)?publisher", r""),
    "subscribes": (r"subscribe(?:Camera)?", r"create_(?:camera_)?subscription", r""),
    "provides": (r"advertiseService", r"create_service", r""),
    "calls": (r"serviceClient", r"create_client", r"\bros::service::call"),
    "serves action": (r"", r"", rf"\brclcpp_action::create_server|{_NEW}SimpleActionServer"),
    "calls action": (r"", r"", rf"\brclcpp_action::create_client|{_NEW}SimpleActionClient"),
    "has parameter": (
        r"param|getParam|getParamCached|hasParam|setParam",
        r"declare_parameter|get_parameter|get_parameter_or|has_parameter",
        r"\bros::param::(?:get|getCached|param|has|set)",
    ),
}
"""For each kind, the names of methods, of functions without a receiver, and whole expressions."""
_PYTHON_CALLS: Final = {
    "publishes": r"\brospy\.Publisher|\.create_publisher",
    "subscribes": r"\b(?:rospy|message_filters)\.Subscriber|\.create_subscription",
    "provides": r"\brospy\.Service|\.create_service",
    "calls": r"\brospy\.ServiceProxy|\.create_client",
    "serves action": r"(?<!class )\b(?:Simple)?ActionServer",
    "calls action": r"(?<!class )\b(?:Simple)?ActionClient",
    "has parameter": r"\brospy\.(?:get_param|has_param|set_param|get_param_cached)"
    r"|\.(?:declare_parameter|get_parameter|get_parameter_or|has_parameter)",
}
KINDS: Final = tuple(_CPP_CALLS)
"""The relations whose calls are searched for."""
_WHOLE, _IS_MEMBER, _IS_FREE = "whole", "member", "free"
_QUALIFIED: Final = re.compile(r"(?:rclcpp|image_transport)::$")
_BEFORE_FREE: Final = tuple("=([{},;&|?:!")


def _compiled(members: str, free: str, whole: str) -> re.Pattern[str]:
    named = [(_IS_MEMBER, members and rf"\b(?:{members})"), (_IS_FREE, free and rf"\b(?:{free})"), (_WHOLE, whole)]
    return re.compile("|".join(rf"(?P<{name}>(?:{text}){_OPENS})" for name, text in named if text))


_PATTERNS: Final = {
    "cpp": [(kind, _compiled(*names)) for kind, names in _CPP_CALLS.items()],
    "python": [(kind, _compiled("", "", text)) for kind, text in _PYTHON_CALLS.items()],
}
_MENTIONS: Final = re.compile(
    r"advertise|ubscri|erviceClient|create_|ros::|rospy\.|Action(?:Server|Client)|[pP]aram\b|Param|parameter"
)
"""Words that every file with a call contains."""


@dataclass(frozen=True, slots=True)
class Site:
    """A call: its kind, the line of the called name, and the first and the last line of its statement."""

    kind: str
    line: int
    first: int
    last: int


def without_words(text: str, language: str) -> str:
    """Return C++ or Python with comments, strings and directives replaced by spaces; positions are unchanged."""
    pattern = _CPP_WORDS if language == "cpp" else _PYTHON_WORDS
    text = pattern.sub(lambda match: _KEPT.sub(" ", match[0]), text)
    return _DEFINE.sub(lambda match: _KEPT.sub(" ", match[0]), text) if language == "cpp" else text


def sites(text: str, language: str) -> Iterator[Site]:
    """Yield the calls in a text of C++ (`cpp`) or Python (`python`), by kind."""
    if not _MENTIONS.search(text):
        return
    code = without_words(text, language)
    starts = [0, *(match.end() for match in re.finditer("\n", code))]
    for kind, pattern in _PATTERNS[language]:
        for match in pattern.finditer(code):
            if _is_call(code, match.start(), match.lastgroup):
                at = match.end() - 1
                line = bisect_right(starts, at)
                first = bisect_right(starts, _statement_start(code, match.start(), language))
                last = bisect_right(starts, statement_end(code, at))
                yield Site(kind, line, min(first, line), max(last, line))


def _is_call(code: str, at: int, how: str | None) -> bool:
    """Return whether a C++ name is called, rather than declared, judging by the text before it."""
    if how == _WHOLE:
        return True
    before = code[max(0, at - _FURTHEST // 10) : at].rstrip()
    before = before.removesuffix("template").rstrip()
    if before.endswith((".", "->")):
        return True
    before = _QUALIFIED.sub("", before).rstrip()
    free = before.endswith(_BEFORE_FREE) and not before.endswith("::")
    return how == _IS_FREE and (free or not before or re.search(r"\breturn$", before) is not None)


_FURTHEST: Final = 4_000
"""Maximum length of a statement in characters."""


def _statement_start(code: str, at: int, language: str) -> int:
    """Return the approximate start of the statement around a position."""
    begin = max(0, at - _FURTHEST)
    before = code[begin:at]
    if language == "cpp":
        cut = max(before.rfind(";"), before.rfind("{"), before.rfind("}")) + 1
    else:
        cut = before.rfind("\n") + 1
        while cut and before[: cut - 1].rstrip(" \t").endswith(("(", ",", "\\", "[")):
            cut = before.rfind("\n", 0, cut - 1) + 1
    blanks = len(code[begin + cut : at]) - len(code[begin + cut : at].lstrip())
    return begin + cut + blanks


def statement_end(code: str, at: int) -> int:
    """Return the end of the brackets that are open at a position, or of the statement."""
    depth = 0
    for place in range(at, min(len(code), at + _FURTHEST)):
        sign = code[place]
        if sign in "([{":
            depth += 1
        elif sign in ")]}":
            depth -= 1
            if depth <= 0:
                return place
        elif sign == ";" and depth <= 0:
            return place
    return at


def line_end(code: str) -> int:
    """Return the end of the first line, or of the line that closes all its brackets."""
    depth = 0
    for place, sign in enumerate(code):
        if sign in "([{":
            depth += 1
        elif sign in ")]}":
            depth -= 1
        elif sign == "\n" and depth <= 0:
            return place
    return len(code)


class Places:
    """The lines of all ends and parameters of a store, the digests of its files, and the folders of its packages."""

    def __init__(self, snapshot: EmbeddedSnapshot) -> None:
        self._lines: defaultdict[tuple[str, str, str], set[int]] = defaultdict(set)
        self._digests: dict[tuple[str, str], str] = {}
        self._folders: defaultdict[str, set[str]] = defaultdict(set)
        for record in node_records(columns_of(snapshot)):
            for relation, part, _ in stated(record):
                for place in (part.location, *part.via[-1:]):
                    self._lines[relation, place.repository or record.repository, place.path].add(place.line)
        for graph in snapshot.graphs():
            if is_source_graph(graph.value):
                for (repository,) in rows(snapshot, _REPOSITORY % graph):
                    for path, value in rows(snapshot, _FILES % graph):
                        self._digests[repository, path] = value
                    self._folders[repository].update(folder or "." for (folder,) in rows(snapshot, _FOLDERS % graph))

    def has(self, relation: str, file: tuple[str, str], first: int, last: int) -> bool:
        """Return whether the graph has an end or parameter of a relation on some lines of a file of a source."""
        return any(first <= line <= last for line in self._lines.get((relation, *file), ()))

    def digest(self, repository: str, path: str) -> str | None:
        """Return the digest of a file when it was read; None for a file outside of packages."""
        return self._digests.get((repository, path))

    def folders(self, repository: str) -> set[str]:
        """Return the folders of the packages of a source, `.` for the whole."""
        return self._folders[repository]


@dataclass(frozen=True, slots=True)
class Miss:
    """A call missing from the graph, or a fact whose line does not contain it."""

    measure: str
    kind: str
    address: str
    text: str


@dataclass(frozen=True, slots=True)
class Checked:
    """The table, and the misses."""

    table: Table
    missed: tuple[Miss, ...]


@dataclass(slots=True)
class _Comparison:
    """The calls of all files by kind, as pairs of file and call, and the files that could not be compared."""

    calls: defaultdict[str, list[tuple[tuple[str, str], Site]]] = field(default_factory=lambda: defaultdict(list))
    left_out: Counter[str] = field(default_factory=Counter)
    files: int = 0


def check_code(snapshot: EmbeddedSnapshot, lines: SourceLines, size: int, seed: int, *, tests: bool = False) -> Checked:
    """Check samples of `size` calls and `size` facts; deterministic for the same store, code and seed.

    Test files are searched for calls only with `tests`: most of their code is not part of a node.
    """
    places = Places(snapshot)
    compared = _calls(places, lines, tests=tests)
    rows: list[tuple[Cell, ...]] = []
    missed: list[Miss] = []
    chance = random.Random(seed)  # noqa: S311 - no secret
    numbers = shares_of({kind: len(compared.calls[kind]) for kind in KINDS}, size)
    drawn_calls = [(kind, call) for kind in KINDS for call in chance.sample(compared.calls[kind], numbers[kind])]
    judged_calls = [(kind, places.has(kind, file, site.first, site.last)) for kind, (file, site) in drawn_calls]
    rows += _rows(_CALLS, judged_calls, {kind: len(calls) for kind, calls in compared.calls.items()})
    for (kind, (file, site)), (_, has_it) in zip(drawn_calls, judged_calls, strict=True):
        if not has_it:
            missed.append(_miss(_CALLS, kind, lines, (*file, site.line)))
    facts = Facts(snapshot)
    judged, absent = _facts(facts, lines, size, seed)
    sizes = {relation: len(facts.listed.get(relation, ())) for relation in STATED}
    rows += _rows(_FACTS, [(fact.relation, right) for fact, right in judged], sizes)
    missed += (
        _miss(_FACTS, fact.relation, lines, (fact.file_repository, fact.path, fact.line))
        for fact, right in judged
        if not right
    )
    remarks = [f"{compared.files:,} files of C++ and Python were searched for calls."]
    if compared.left_out:
        remarks.append(
            f"Left out: {'; '.join(f'{number:,} {why}' for why, number in compared.left_out.most_common())}."
        )
    if absent:
        remarks.append(f"{absent:,} sampled facts are in files that are missing or have changed.")
    notes = tuple(remarks)
    table = Table("code", "The graph against the code", ("measure", "kind", "share", "number"), tuple(rows), notes)
    return Checked(with_paper(table, ("measure", "kind")), tuple(missed))


def _rows(measure: str, judged: Iterable[tuple[str, bool]], sizes: Mapping[str, int]) -> Iterator[tuple[Cell, ...]]:
    counts: dict[str, list[int]] = {kind: [0, 0] for kind in KINDS}
    for kind, is_right in judged:
        counts[kind][0] += is_right
        counts[kind][1] += 1
    for kind, (right, looked) in counts.items():
        if looked:
            yield measure, kind, share(right, looked), sizes.get(kind, 0)
    every = weighed((sizes.get(kind, 0), looked, right) for kind, (right, looked) in counts.items() if looked)
    yield measure, _ALL, every or Share(0, 0), sum(sizes.values())


def _miss(measure: str, kind: str, lines: SourceLines, place: tuple[str, str, int]) -> Miss:
    return Miss(measure, kind, lines.address(*place), lines.text(*place) or "")


def _calls(places: Places, lines: SourceLines, *, tests: bool) -> _Comparison:
    """Search the C++ and Python files in the packages of the store, if they are unchanged on this machine."""
    compared = _Comparison()
    for repository in sorted(lines.states):
        root = lines.root(repository)
        if root is None:
            compared.left_out["sources that are not on this machine"] += 1
            continue
        folders = places.folders(repository)
        for path in _files(root):
            if folders.isdisjoint([*map(str, PurePosixPath(path).parents)]):
                continue
            if not tests and _TEST.search(path):
                compared.left_out["files of tests"] += 1
                continue
            _search(repository, root, path, places, compared)
    return compared


def _search(repository: str, root: Path, path: str, places: Places, compared: _Comparison) -> None:
    try:
        data = (root / path).read_bytes()
    except OSError:
        compared.left_out["files that cannot be read"] += 1
        return
    if places.digest(repository, path) not in {None, digest(data)}:
        compared.left_out["files that were changed since"] += 1
        return
    compared.files += 1
    language = "python" if PurePosixPath(path).suffix.lower() in PYTHON else "cpp"
    for site in sites(data.decode("utf-8", "replace"), language):
        compared.calls[site.kind].append(((repository, path), site))


def _files(root: Path) -> Iterator[str]:
    """Yield the sorted paths of C++ and Python files below a folder, without hidden folders."""
    for folder, inner, names in os.walk(root):
        inner[:] = sorted(name for name in inner if not name.startswith("."))
        for name in sorted(names):
            path = Path(folder, name)
            if path.suffix.lower() in CPP | PYTHON and path.is_file() and path.stat().st_size <= _LARGEST:
                yield path.relative_to(root).as_posix()


def _facts(facts: Facts, lines: SourceLines, size: int, seed: int) -> tuple[list[tuple[Fact, bool]], int]:
    """Return sampled facts with whether their lines contain them, and the number of those without a line here."""
    judged, absent = [], 0
    for relation, pair in drawn(facts, STATED, size, seed):
        fact = facts.fact(relation, pair)
        if fact.call is not None:  # the line that calls the framework counts, also in another package than the node's
            source = fact.call.repository or fact.repository
            fact = replace(fact, file_repository=source, path=fact.call.path, line=fact.call.line)
        text = lines.lines(fact.file_repository, fact.path)
        if not 0 < fact.line <= len(text):
            absent += 1
        else:
            judged.append((fact, holds(fact, text)))
    return judged, absent


_WORDS: Final = {
    "publishes": r"advertise|ublish",
    "subscribes": r"ubscri|Filter",
    "provides": r"ervice|advertise|[sS]rv|Server",
    "calls": r"lient|ervice|[sS]rv|Proxy",
    "serves action": r"ction|[sS]erver|^\s*[:,]?\s*\w+_\s*[({]",
    "calls action": r"ction|lient|^\s*[:,]?\s*\w+_\s*[({]",
    "has parameter": r"",
}
_MOST: Final = 12
"""Maximum number of lines of a statement."""
_BLANKS: Final = re.compile(r"\s+")
_SEGMENTS: Final = re.compile(r"[/.~]|\{[^}]*\}")


def holds(fact: Fact, lines: Sequence[str]) -> bool:
    """Return whether the statement at a fact's line contains its call, and its name or written expression.

    Only the last part of a name counts, since namespaces and prefixes are written elsewhere. Parameter files only need
    to contain the name.
    """
    text = "\n".join(lines[fact.line - 1 : fact.line - 1 + _MOST])
    statement = text[: line_end(text) + 1]
    is_code = PurePosixPath(fact.path).suffix.lower() in CPP | PYTHON
    called = not is_code or re.search(_WORDS[fact.relation], statement) is not None
    return called and _named(fact, statement)


def _named(fact: Fact, statement: str) -> bool:
    if fact.written and _BLANKS.sub("", fact.written) in _BLANKS.sub("", statement):
        return True
    parts = [part for part in _SEGMENTS.split(fact.value or "") if part]
    return parts[-1] in statement if parts else not fact.written
