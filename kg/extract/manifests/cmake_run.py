"""A static interpreter of CMake: the declarations of a package's CMakeLists.txt, without configuring it.

Conditions that can be decided are; of others every branch is run and the variables are united. Macros and
functions of the package are run with their arguments; those of other packages are looked up in the build,
then in `ontology/cmake-macros.cmake`, which describes well known ones in terms of the commands known here.
Everything is bounded: statements, depth, lengths of values.
"""

from __future__ import annotations

import fnmatch
import posixpath
import re
from collections import deque
from dataclasses import dataclass
from enum import Enum
from functools import cache, lru_cache
from typing import TYPE_CHECKING, Final

from kg.corpus.files import FilePath, PackageFolder
from kg.extract.manifests.cmake_conditions import Token, decide
from kg.extract.manifests.cmake_scope import Scope, split_list
from kg.extract.manifests.cmake_syntax import Block, Command, Statement, parse
from kg.facts import FileKind, Location
from kg.resources import folder

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence

    from kg.corpus.reading import Reader

SOURCE: Final = "/@source"
"""Stands for the root of the source in paths that CMake code computes."""
BINARY: Final = "/@binary"
"""Stands for the root of the build folder; nothing below it exists."""

DEFINING: Final = (
    "add_definitions",
    "add_compile_definitions",
    "add_compile_options",
    "target_compile_definitions",
    "target_compile_options",
)
"""The commands that define macros for C++."""
_STATEMENT: Final = 200
"""What running a statement costs, where looking at one character or file costs one."""
_WORD: Final = 20
"""What a command costs for each of its arguments."""
_MOST_WORK: Final = 20_000_000
_DEEPEST_CALLS: Final = 40
_MOST_ROUNDS: Final = 2_000


class _Flow(Enum):
    NEXT = 0
    BREAK = 1
    CONTINUE = 2
    RETURN = 3


@dataclass(frozen=True, slots=True)
class Definition:
    """A macro or function: its parameters, its body and the folder (as `SOURCE` path) of the file it is in."""

    macro: bool
    parameters: tuple[str, ...]
    body: Sequence[Statement]
    folder: str


@dataclass(slots=True)
class _Frame:
    """Place of execution: the file, the folder of the CMakeLists.txt, and the call that led here from it."""

    path: str
    folder: str
    call: Location | None = None


PROGRAM_OF_A_LIBRARY: Final = "kg program of a library"
"""The handler of commands that packages outside of the build define, and whose names say that they make a program."""
_MAKES_PROGRAM: Final = re.compile(r"_(?:executable|binary)$")


class Run:
    """One run over a package's CMake files; `handlers` are the commands that do something, by name in lower case."""

    def __init__(
        self, files: CMakeFiles, scope: Scope, handlers: Mapping[str, Callable[[Run, list[str]], None]]
    ) -> None:
        self.files = files
        self.scope = scope
        self.handlers = handlers
        self.definitions: dict[str, Definition] = {}
        self.certain = True
        self.stopped: Location | None = None
        """Where the work that a package may cost was used up; nothing is run any more then."""
        self.too_deep: Location | None = None
        """The first block that was left out because it stands too deep."""
        self.macros: dict[str, str] = {}
        """The macros that the commands define for C++, with what they stand for."""
        self.left_out: set[str] = set()
        """The macros that commands in branches define that are not run."""
        self._frame = _Frame("", SOURCE)
        self._depth = 0
        self._work = 0
        self._line = 1

    @property
    def location(self) -> Location:
        """The command being run; within a macro or function the outermost call of it."""
        return self._frame.call or Location(self._frame.path, self._line)

    @property
    def folder(self) -> str:
        """The folder of the CMakeLists.txt being run, as a path below `SOURCE`."""
        return self._frame.folder

    def run_file(self, path: str, *, own_folder: bool) -> None:
        """Run a file of the source; with `own_folder` it is a CMakeLists.txt with a scope and folder of its own."""
        statements = self.files.parse(path)
        if statements is None or self._depth >= _DEEPEST_CALLS:
            return
        outer, scope = self._frame, self.scope
        folder = posixpath.join(SOURCE, posixpath.dirname(path)).rstrip("/")
        self._frame = _Frame(path, folder if own_folder else outer.folder, outer.call)
        if own_folder:
            self.scope = scope.child()
            self.scope.set("CMAKE_CURRENT_SOURCE_DIR", folder)
            self.scope.set("CMAKE_CURRENT_BINARY_DIR", folder.replace(SOURCE, BINARY, 1))
        self.scope.set("CMAKE_CURRENT_LIST_DIR", folder)
        self.scope.set("CMAKE_CURRENT_LIST_FILE", posixpath.join(SOURCE, path))
        self._depth += 1
        self.execute(statements)
        self._depth -= 1
        if own_folder:
            self.scope = scope
        self._frame = outer
        self.scope.set("CMAKE_CURRENT_LIST_DIR", posixpath.dirname(posixpath.join(SOURCE, outer.path)))

    def execute(self, statements: Sequence[Statement]) -> _Flow:
        """Run statements in a row; stops early for return, break and continue, and when the budget is used up."""
        for statement in statements:
            if not self._may_go_on():
                return _Flow.RETURN
            flow = self._command(statement) if isinstance(statement, Command) else self._block(statement)
            if flow is not _Flow.NEXT:
                return flow
        return _Flow.NEXT

    def _may_go_on(self) -> bool:
        """Count a statement or a round of a loop; return whether the work allowed is not used up."""
        self._work += _STATEMENT
        if self._work > _MOST_WORK:
            self.stopped = self.stopped or self.location
        return self.stopped is None

    def spend(self, work: int) -> None:
        """Count work that a command does beyond its own arguments."""
        self._work += work

    def arguments(self, command: Command) -> list[str]:
        """Return the arguments after evaluation; `certain` is then whether all of them are certain."""
        tokens = self._tokens(command)
        self.certain = all(token.certain for token in tokens)
        return [token.text for token in tokens if token.text or token.quoted]

    def _command(self, command: Command) -> _Flow:
        name = command.name
        if name in {"return", "break", "continue"}:
            return _Flow[name.upper()]
        self._line = command.line
        definition = self.definitions.get(name)
        if definition is None:
            handler = self.handlers.get(name)
            if handler is not None:
                handler(self, self.arguments(command))
                return _Flow.NEXT
            definition = self.files.definition(name)
        if definition is None and _MAKES_PROGRAM.search(name) and PROGRAM_OF_A_LIBRARY in self.handlers:
            self.handlers[PROGRAM_OF_A_LIBRARY](self, self.arguments(command))
        if definition is not None:
            self._call(definition, command)
        return _Flow.NEXT

    def _call(self, definition: Definition, command: Command) -> None:
        if self._depth >= _DEEPEST_CALLS:
            return
        values = self.arguments(command)
        self.spend(len(self.scope.variables))
        outer, frame, before = self.scope, self._frame, dict(self.scope.variables)
        self._frame = _Frame(frame.path, frame.folder, self.location)
        if not definition.macro:
            self.scope = outer.child()
        bound = self._bind(definition, values)
        self._depth += 1
        self.execute(definition.body)
        self._depth -= 1
        if definition.macro:
            for name in bound:
                self.scope.set(name, before[name]) if name in before else self.scope.unset(name)
        self.scope, self._frame = outer, frame

    def _bind(self, definition: Definition, values: list[str]) -> list[str]:
        """Set the parameters of a call as variables and return their names."""
        named = dict(zip(definition.parameters, values, strict=False))
        rest = values[len(definition.parameters) :]
        bound = {**named, "ARGN": ";".join(rest), "ARGV": ";".join(values), "ARGC": str(len(values))}
        bound |= {f"ARGV{index}": value for index, value in enumerate(values[:20])}
        bound["CMAKE_CURRENT_FUNCTION_LIST_DIR"] = definition.folder
        for name, value in bound.items():
            self.scope.set(name, value)
        return list(bound)

    def _block(self, block: Block) -> _Flow:
        opener, body = block.branches[0]
        if self._depth >= _DEEPEST_CALLS:
            self.too_deep = self.too_deep or Location(self._frame.path, opener.line)
            return _Flow.NEXT
        self._depth += 1
        flow = _Flow.NEXT
        if opener.name == "if":
            flow = self._if(block)
        elif opener.name == "foreach":
            flow = self._foreach(opener, body)
        elif opener.name == "while":
            flow = self._while(opener, body)
        else:
            self._define(opener, body)
        self._depth -= 1
        return flow

    def _define(self, opener: Command, body: list[Statement]) -> None:
        names = self.arguments(opener)
        if names:
            folder = posixpath.dirname(posixpath.join(SOURCE, self._frame.path))
            definition = Definition(opener.name == "macro", tuple(names[1:]), body, folder)
            self.definitions[names[0].lower()] = definition

    def _if(self, block: Block) -> _Flow:
        outer = self.scope
        self.spend(4 * len(outer.variables))
        outcomes: list[Scope] = []
        for index, (command, body) in enumerate(block.branches):
            verdict = True if command.name == "else" else decide(self._tokens(command), self.scope)
            if verdict is False:
                self.left_out |= _macros_in(body)
                continue
            if verdict and not outcomes:
                self.left_out |= {name for _, other in block.branches[index + 1 :] for name in _macros_in(other)}
                return self.execute(body)
            self.scope = Scope(dict(outer.variables), set(outer.uncertain), outer.parent)
            self.execute(body)
            outcomes.append(self.scope)
            self.scope = outer
            if verdict:
                break
        else:
            outcomes.append(Scope(dict(outer.variables), set(outer.uncertain), outer.parent))
        outer.merge(outcomes)
        return _Flow.NEXT

    def _tokens(self, command: Command) -> list[Token]:
        """Return the arguments after evaluation; one that is not certain and empty is there for its doubt."""
        tokens: list[Token] = []
        for argument in command.arguments:
            if argument.form in {"bracket", "paren"}:
                tokens.append(Token(argument.text, quoted=argument.form == "bracket"))
                continue
            text, certain = self.scope.expand(argument.text)
            self._work += len(text)
            if argument.form == "quoted":
                tokens.append(Token(text, quoted=True, certain=certain))
            else:
                tokens.extend(Token(part, certain=certain) for part in split_list(text) or ([] if certain else [""]))
        self._work += _WORD * len(tokens)
        return tokens

    def _foreach(self, opener: Command, body: list[Statement]) -> _Flow:
        arguments = self.arguments(opener)
        if not arguments:
            return _Flow.NEXT
        name, before = arguments[0], self.scope.variables.get(arguments[0])
        for item in _items(arguments[1:], self.scope)[:_MOST_ROUNDS]:
            self.scope.set(name, item)
            flow = self.execute(body) if self._may_go_on() else _Flow.RETURN
            if flow is _Flow.RETURN:
                return flow
            if flow is _Flow.BREAK:
                break
        self.scope.unset(name) if before is None else self.scope.set(name, before)
        return _Flow.NEXT

    def _while(self, opener: Command, body: list[Statement]) -> _Flow:
        for _ in range(_MOST_ROUNDS):
            verdict = decide(self._tokens(opener), self.scope)
            if verdict is False:
                break
            flow = self.execute(body) if self._may_go_on() else _Flow.RETURN
            if flow is _Flow.RETURN and verdict:
                return flow
            if flow in {_Flow.BREAK, _Flow.RETURN} or verdict is None:
                break
        return _Flow.NEXT


def macros_of(command: str, words: Iterable[str]) -> Iterator[tuple[str, str]]:
    """Yield the macros that a command with some arguments defines for C++, with their texts: `-DNAME`, `NAME=1`."""
    for word in words if command in DEFINING else ():
        name, _, text = word.removeprefix("-D").partition("=")
        if name.isidentifier() and (word.startswith("-D") or command.endswith("compile_definitions")):
            yield name, text


def _macros_in(statements: Sequence[Statement]) -> set[str]:
    """Return the macros that statements define for C++, those in blocks too."""
    macros: set[str] = set()
    pending = list(statements)
    while pending:
        one = pending.pop()
        if isinstance(one, Command):
            words = (word for argument in one.arguments for word in argument.text.split())
            macros.update(name for name, _ in macros_of(one.name, words))
        else:
            pending += [inner for _, body in one.branches for inner in body]
    return macros


def _items(words: list[str], scope: Scope) -> list[str]:
    """Return the items of a foreach: `RANGE`, `IN LISTS ... ITEMS ...` or the words themselves."""
    if words[:1] == ["RANGE"]:
        return _range(words[1:])
    if words[:1] != ["IN"]:
        return words
    items: list[str] = []
    mode = ""
    for word in words[1:]:
        if word in {"LISTS", "ITEMS", "ZIP_LISTS"}:
            mode = word
        elif mode == "ITEMS":
            items.append(word)
        else:
            items.extend(split_list(scope.variables.get(word, "")))
    return items


def _range(words: list[str]) -> list[str]:
    try:
        numbers = [int(word[:9]) for word in words]
    except ValueError:
        return []
    if not numbers:
        return []
    start, stop, step = (0, numbers[0], 1) if len(numbers) == 1 else (*numbers[:2], (numbers[2:] or [1])[0])
    return (
        [str(number) for number in range(start, min(stop, start + step * _MOST_ROUNDS) + 1, step)] if step > 0 else []
    )


_PLACEHOLDER: Final = re.compile(r"@(\w+)@|\$\{(\w+)\}")
_SOURCE_ENDINGS: Final = ("cpp", "cc", "cxx", "c", "cu")
_REMEMBERED: Final = 256
"""Texts whose definitions are kept, for the macros of one package are called by many."""


class CMakeFiles:
    """Files of one package's source as CMake code sees them; paths are relative to the root of the source."""

    def __init__(self, reader: Reader, package: PackageFolder) -> None:
        self.reader = reader
        self.package = package
        self.packages: dict[str, None] = {}
        """Other packages that were asked for with find_package, whose macros may be called."""
        self.generated: dict[str, tuple[str, str]] = {}
        """Files that configure_file makes, by their path below `BINARY`: the template and the text it becomes."""
        self._parsed: dict[str, list[Statement] | None] = {}
        self._definitions: dict[tuple[str, int], Definition | None] = {}
        self._libraries: dict[str, dict[str, Definition]] = {}
        self._links = reader.workspace.links(reader.repository)
        self._entries = {entry.path: entry for entry in package.files}

    @property
    def size(self) -> int:
        """Number of files of the package, which is the cost of a pattern."""
        return len(self._entries)

    def parse(self, path: str) -> list[Statement] | None:
        """Return the statements of a CMake file; None, and a problem, when it cannot be read."""
        if path not in self._parsed:
            text = self.reader.read(path)
            statements, faults = parse(text.decode("utf-8", "replace")) if text is not None else (None, [])
            for fault in faults:
                self.reader.problem("KG117", fault.message, path, fault.line)
            self._parsed[path] = statements
        return self._parsed[path]

    def locate(self, written: str, base: str) -> str | None:
        """Return the path of `written`, relative to `base` below `SOURCE`; None for one outside of the source."""
        whole = posixpath.normpath(posixpath.join(base, written))
        if whole.startswith(BINARY) or not (whole == SOURCE or whole.startswith(SOURCE + "/")):
            return None
        path = whole[len(SOURCE) + 1 :]
        for link, target in self._links:
            if path.startswith(link + "/"):
                return posixpath.normpath(target + path[len(link) :])
        return path

    def exists(self, path: str) -> bool:
        """Return whether the source has that file."""
        return path in self._entries or self.reader.workspace.entry(self.reader.file(path)) is not None

    def source_file(self, written: str, base: str) -> str | None:
        """Return the path of a source of a target, with the ending that CMake adds; None if it does not exist."""
        path = self.locate(written, base)
        if path is None:
            return None
        if self.exists(path):
            return path
        return next((full for ending in _SOURCE_ENDINGS if self.exists(full := f"{path}.{ending}")), None)

    def configured(self, template: str, variables: Mapping[str, str]) -> str:
        """Return the text of a template with `@NAME@` and `${NAME}` replaced, as configure_file does."""
        text = (self.reader.read(template) or b"").decode("utf-8", "replace")
        return _PLACEHOLDER.sub(lambda match: variables.get(match[1] or match[2], ""), text)

    def glob(self, pattern: str, base: str, *, recurse: bool) -> list[str]:
        """Return the files of the package that a pattern of `file(GLOB)` matches, sorted."""
        located = self.locate(pattern, base)
        if located is None:
            return []
        head, tail = posixpath.split(located)
        plain = not any(mark in head for mark in "*?[")
        match = re.compile(fnmatch.translate(tail)).match
        inside = re.compile(fnmatch.translate(head)).match
        paths = []
        for path in self._entries:
            where, name = posixpath.split(path)
            near = where == head if plain else inside(where) and where.count("/") == head.count("/")
            below = recurse and (where.startswith(head + "/") or not head)
            if (near or below) and match(name):
                paths.append(path)
        return paths

    def module(self, name: str, base: str) -> str | None:
        """Return the file that `include(name)` means: a path, or a module in a folder `cmake` of the package."""
        for candidate in (name, f"{name}.cmake"):
            path = self.locate(candidate, base)
            if path and self.exists(path):
                return path
        wanted = f"/{posixpath.basename(name).removesuffix('.cmake')}.cmake"
        fits = [path for path in self._entries if path.endswith(wanted)]
        return min(fits, key=len, default=None)

    def definition(self, name: str) -> Definition | None:
        """Return the macro or function `name` of this package, of one found, of the build, or of the known ones."""
        key = (name, len(self.packages))
        if key not in self._definitions:
            libraries = map(self._library, (self.package.name, *self.packages))
            own = next((library[name] for library in libraries if name in library), None)
            self._definitions[key] = own or _bundled_macros().get(name)
        return self._definitions[key]

    def _library(self, package: str) -> dict[str, Definition]:
        """Return the macros and functions in the `.cmake` files of a package of the build."""
        if package not in self._libraries:
            library = self._libraries[package] = {}
            workspace = self.reader.workspace
            place = workspace.package(package, self.reader.repository)
            for entry in workspace.files(place, FileKind.BUILD) if place else ():
                if place and ".cmake" in entry.path:
                    text = self.reader.read(FilePath(place.repository, entry.path)) or b""
                    base = posixpath.dirname(posixpath.join(SOURCE, entry.path))
                    for name, definition in _definitions(text, base).items():
                        library.setdefault(name, definition)
        return self._libraries[package]


@lru_cache(_REMEMBERED)
def _definitions(text: bytes, base: str) -> Mapping[str, Definition]:
    """Return the macros and functions that a file in the folder `base` defines; of two alike the first."""
    lower = text.lower()
    if b"macro" not in lower and b"function" not in lower:
        return {}
    definitions: dict[str, Definition] = {}
    for name, definition in _collect(parse(text.decode("utf-8", "replace"))[0], base):
        definitions.setdefault(name, definition)
    return definitions


def _collect(statements: Iterable[Statement], base: str) -> Iterator[tuple[str, Definition]]:
    """Yield the definitions among statements, those inside of `if` too."""
    pending = deque(statements)
    while pending:
        statement = pending.popleft()
        if not isinstance(statement, Block):
            continue
        opener, body = statement.branches[0]
        words = tuple(argument.text for argument in opener.arguments)
        if opener.name in {"macro", "function"} and words:
            yield words[0].lower(), Definition(opener.name == "macro", words[1:], body, base)
        elif opener.name == "if":
            pending.extend(inner for _, branch in statement.branches for inner in branch)


@cache
def _bundled_macros() -> Mapping[str, Definition]:
    return _definitions((folder("ontology") / "cmake-macros.cmake").read_bytes(), "")
