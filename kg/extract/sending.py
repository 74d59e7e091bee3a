"""What code does with its publishers and subscriptions, by the text of the files that create them.

Each is stated only where the text leaves no doubt:

* `silent`: nothing is published on it. Its variable is found in the statement that creates it, and is only assigned,
  tested, counted or shut down. Any other use, such as passing it on, may publish.
* `upon`: all calls that publish are in callbacks of subscriptions, or in functions that only these call.
* `unset` and `filled`: parts of its message that stay empty, and parts that are set (`kg.extract.filling`).
* `ignored`: the callback of a subscription does nothing with the messages (`kg.extract.ignoring`).

An end that several calls create, for different variables, has none of these.

The interpretation does not show it: callbacks in which nothing is declared do not run (`kg.symbolic.reach`).
"""

from __future__ import annotations

import re
from dataclasses import dataclass, field, replace
from functools import cache
from pathlib import PurePosixPath
from typing import TYPE_CHECKING, Final, NamedTuple

from kg.extract.codetext import CodeText
from kg.extract.filling import set_parts, unset_parts
from kg.extract.ignoring import ignores_messages
from kg.facts import FileKind, Role

if TYPE_CHECKING:
    from collections.abc import Iterator

    from kg.corpus.files import PackageFolder
    from kg.corpus.reading import Reader
    from kg.facts import Interface, NodeType

_CREATES: Final = re.compile(r"\b(?:advertise\w*|create_(?:generic_)?publisher|Publisher)\s*[<(]")
_CREATES_LINES: Final = 3
"""Lines from that of a call on which its last name is."""
_CHAIN: Final = r"(?:[\w.:*]|->|\(\s*\)|\s)*\Z"
"""What is between a variable and the name of the method that creates its value: `this->get_node()->`."""
_ASSIGNED: Final = re.compile(r"\b([A-Za-z_]\w*)\s*(?:\[[^\[\]]*\]\s*)?(?::[^=:;]+)?=\s*" + _CHAIN)
_INITIALISED: Final = re.compile(r"[,:]\s*([A-Za-z_]\w*)\s*[({]\s*" + _CHAIN)
_TESTED: Final = re.compile(r"\b(?:if|elif|while)\s*\(?\s*(?:!|not\b)?\s*(?:self\.|this->)?\Z")
_DESTROYED: Final = re.compile(r"\bdestroy_publisher\(\s*(?:self\.|this->)?\Z")
_DECLARED_TYPE: Final = re.compile(r"\b(?:\w*Publisher\w*|auto|\w*Ptr)\b[^(){}=]*?[\s>*&,]\Z")
_AFTER_DECLARED: Final = re.compile(r"\s*[;,={(\[]")
_ASSIGNS: Final = re.compile(r"\s*=(?!=)")
_OPENED: Final = re.compile(r"\s*[({]")
_LISTED: Final = re.compile(r"(?:,|(?<!:):)\s*\Z")
_LOOKED_AT: Final = 200
"""Characters before a name that show what it is."""
_PUBLISHES: Final = re.compile(r"\s*(?:\[[^\[\]]*\]\s*)?(?:\.|->)\s*publish\b|\(")
"""What follows a publisher that publishes; one of C++ may be an object that is called."""
_CLASS: Final = re.compile(r"^[ \t]*(?:class|struct)\s+(?:[A-Z_]+\s+)?(\w+)\b(?!\s*;)", re.MULTILINE)
_SOURCES: Final = (".c", ".cc", ".cpp", ".cxx", ".py")
"""Endings of files that no other file includes."""
_DEEPEST: Final = 4
"""How many functions may be between a callback and a call that publishes."""


def add_sending(
    nodes: tuple[NodeType, ...], reader: Reader, package: PackageFolder, silent_methods: frozenset[str]
) -> tuple[NodeType, ...]:
    """Return the nodes of a package with what its code does with their publishers and subscriptions.

    `silent_methods` are the methods of publishers that publish nothing.
    """
    files = _Files(reader, package, _plain_use(silent_methods))
    return tuple(
        replace(node, interfaces=tuple(_stated(one, node, files) for one in node.interfaces)) for node in nodes
    )


@cache
def _plain_use(silent_methods: frozenset[str]) -> re.Pattern[str]:
    """Return the pattern of what follows a publisher that is assigned, compared, counted or ended."""
    methods = "|".join(sorted(silent_methods))
    return re.compile(rf"\s*(?:\[[^\[\]]*\]\s*)?(?:=(?!=)|[!=]=|is\b|:\s*[\w.]+\s*=|(?:\.|->)\s*(?:{methods})\b)")


def _stated(end: Interface, node: NodeType, files: _Files) -> Interface:
    if end.role not in (Role.PUBLISHES, Role.SUBSCRIBES) or end.implicit or end.location.repository is not None:
        return end
    file = files.get(end.location.path)
    if file is None or not _alone(end, file):
        return end
    if end.role is Role.SUBSCRIBES:
        ignored = not end.via and ignores_messages(file, end.location.line, files.with_word)
        return replace(end, ignored=True) if ignored else end
    variable = _variable(file, end.location.line)
    uses = files.uses(variable, file) if variable is not None else None
    scope = files.scope(variable, file) if variable is not None else []
    if variable is not None and not uses and any(_declared_at(variable, one) is not None for one in scope):
        return replace(end, silent=True)
    unset = unset_parts(end, node, file, uses, files.with_word)
    filled = tuple(part for part in set_parts(end, file) if part not in unset)
    upon = _upon(uses, variable, node, files, scope) if variable is not None and uses else ()
    return replace(end, unset=unset, filled=filled, upon=upon) if unset or filled or upon else end


def _alone(end: Interface, file: CodeText) -> bool:
    """Check whether all calls that create the same end assign it to the same variable."""
    same = not end.again or end.role is Role.PUBLISHES
    variable = _variable(file, end.location.line) if end.again else None
    return same and all(one.path == file.path and _variable(file, one.line) == variable for one in end.again)


@dataclass
class _Files:
    """The code of a package, read on demand."""

    reader: Reader
    package: PackageFolder
    plain_use: re.Pattern[str]
    """What follows a publisher that does not publish."""
    _read: dict[str, CodeText | None] = field(default_factory=dict)
    _uses: dict[tuple[str, str], list[tuple[CodeText, int]]] = field(default_factory=dict)
    _scopes: dict[tuple[str, str], list[CodeText]] = field(default_factory=dict)

    def get(self, path: str) -> CodeText | None:
        """Return a file of the package; None if it cannot be read."""
        if path not in self._read:
            content = self.reader.read(path)
            self._read[path] = CodeText(path, content) if content is not None else None
        return self._read[path]

    def with_word(self, word: str) -> Iterator[CodeText]:
        """Yield the files of code that contain a word."""
        for entry in self.package.files:
            if entry.kind in (FileKind.CPP, FileKind.PYTHON) and word.encode() in (self.reader.read(entry.path) or b""):
                file = self.get(entry.path)
                if file is not None:
                    yield file

    def scope(self, variable: str, file: CodeText) -> list[CodeText]:
        """Return the files that can name a variable or field to which a file assigns a publisher.

        They are the file alone for its own variables; else those with the name of the class, and those that it includes
        or imports.
        """
        key = (variable, file.path)
        if key not in self._scopes:
            self._scopes[key] = list(self._scope(variable, file))
        return self._scopes[key]

    def _scope(self, variable: str, file: CodeText) -> Iterator[CodeText]:
        yield file
        fields = [at for at in file.places(variable) if file.code.endswith(("self.", "cls."), 0, at)]
        if file.path.endswith(_SOURCES) and not fields and _declared_at(variable, file) is not None:
            return
        declared = ((one, _declared_at(variable, one)) for one in self.with_word(variable) if not file.python)
        place = next(((one, at) for one, at in declared if at is not None), None)
        place = (file, fields[0]) if fields else place
        if place is None:
            return
        around = [one[1] for one in _CLASS.finditer(place[0].code, 0, place[1])]
        for other in self.with_word(variable):
            related = not around or around[-1] in other.code or PurePosixPath(other.path).stem in file.code
            if other is not file and other.python == file.python and related:
                yield other

    def uses(self, variable: str, file: CodeText) -> list[tuple[CodeText, int]]:
        """Return the places where a publisher that a file creates may be used to publish."""
        key = (variable, file.path)
        if key not in self._uses:
            self._uses[key] = [
                (one, at) for one in self.scope(variable, file) for at in _uses(variable, one, self.plain_use)
            ]
        return self._uses[key]


def _variable(file: CodeText, line: int) -> str | None:
    """Return the variable or field that gets the publisher created on a line."""
    start = file.line_start(line)
    match = _CREATES.search(file.code, start, file.line_start(line + _CREATES_LINES))
    if match is None:
        return None
    begin = max(file.code.rfind(mark, 0, start) for mark in ("\n" if file.python else ";{}")) + 1
    before = file.code[begin : match.start()]
    if file.python:
        before = before[before.rfind("\n") + 1 :]
    assigned = _ASSIGNED.search(before) or (None if file.python else _INITIALISED.search(before))
    return assigned[1] if assigned is not None else None


def _declared_at(variable: str, file: CodeText) -> int | None:
    """Return where a file declares a variable for publishers; in Python, where it assigns one."""
    for at in file.places(variable):
        end = at + len(variable)
        if _ASSIGNS.match(file.code, end) if file.python else _declares(file, at, end):
            return at
    return None


def _declares(file: CodeText, start: int, end: int) -> bool:
    """Check whether a place is the name in a declaration of a publisher."""
    if _AFTER_DECLARED.match(file.code, end) is None:
        return False
    return _DECLARED_TYPE.search(file.statement_before(start, _LOOKED_AT)) is not None


def _uses(variable: str, file: CodeText, plain_use: re.Pattern[str]) -> Iterator[int]:
    """Yield the places where a file may publish on a variable, or pass it on."""
    code = file.code
    for start in file.places(variable):
        end = start + len(variable)
        before = code[max(0, start - _LOOKED_AT) : start]
        if plain_use.match(code, end) or _TESTED.search(before) or _DESTROYED.search(before):
            continue
        # A constructor that initialises the field, and its declaration, do not publish either.
        initialised = _OPENED.match(code, end) is not None and _LISTED.search(before) is not None
        if file.python or not (initialised or _declares(file, start, end)):
            yield start


class _Subscription(NamedTuple):
    """The call that subscribes to a type, as a part of a file."""

    file: CodeText
    start: int
    end: int
    type: str


def _upon(
    uses: list[tuple[CodeText, int]], variable: str, node: NodeType, files: _Files, scope: list[CodeText]
) -> tuple[str, ...]:
    """Return the types of the subscriptions in whose callbacks all uses of a publisher publish; none if others do."""
    if not all(_PUBLISHES.match(file.code, at + len(variable)) for file, at in uses):
        return ()
    subscriptions = [
        _Subscription(file, *file.call(one.location.line), one.type)
        for one in node.interfaces
        if one.role is Role.SUBSCRIBES and not one.implicit and one.type and one.location.repository is None
        if (file := files.get(one.location.path)) is not None and file in scope
    ]
    result: set[str] = set()
    for file, at in uses:
        causes = _causes(file, at, subscriptions, scope, ())
        if not causes:
            return ()
        result |= causes
    return tuple(sorted(result))


def _causes(
    file: CodeText, at: int, subscriptions: list[_Subscription], scope: list[CodeText], outer: tuple[str, ...]
) -> set[str]:
    """Return the types of the subscriptions that alone lead to a place; none if something else does."""
    for one in subscriptions:
        if one.file is file and one.start <= at <= one.end:
            return {one.type}
    function = file.around(at)
    if function is None or function.name in outer or len(outer) >= _DEEPEST:
        return set()
    result: set[str] = set()
    for caller, place in ((one, place) for one in scope for place in one.names_of(function.name)):
        causes = _causes(caller, place, subscriptions, scope, (*outer, function.name))
        if not causes:
            return set()
        result |= causes
    return result
