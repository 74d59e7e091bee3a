"""Evaluates a robot description as xacro does, as far as plugins of simulators need it: nothing is executed.

Source: wiki.ros.org/xacro and the rules of xacro itself (of ROS 1 and ROS 2, which differ little); files of before its
release for ROS Jade may write commands without prefix. Texts are evaluated only where plugins can depend on them, so
that what is unknown elsewhere does no harm.
"""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, Final

from kg.extract.python.evaluation import HOLE, UnknownValueError
from kg.facts import LaunchProblemKind
from kg.holes import ANONYMOUS
from kg.launch.files.ros1.parameterfile import shown
from kg.launch.files.ros1.substitute import Substituter
from kg.launch.files.xacro.scopes import DESCRIPTION, Block, Element, Macro, Table, called, grab_macro, truth
from kg.launch.files.xacro.texts import Around, Loading, Texts

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Mapping

    from kg.corpus.files import FilePath
    from kg.launch.files.access import Files

_MOST_FILES: Final = 500
_MOST_ELEMENTS: Final = 100_000


def collect(file: FilePath, files: Files, loading: Loading, texts: Texts) -> Table:
    """Return a scope with every macro and property of a file and its includes."""
    table = Table(texts.value)
    waiting, seen, count = [file], {file}, 0
    while waiting:
        current = waiting.pop(0)
        data = loading.data(current)
        root = DESCRIPTION.read(data).root if data is not None else None
        for element in _commands(root) if root is not None else ():
            count += 1
            if count > _MOST_ELEMENTS:
                return table
            defined = _define(table, element, current)
            if defined is None:
                continue
            included = loading.find(texts.text(defined, table), files.folder(current)).file
            if included is not None and included not in seen and len(seen) < _MOST_FILES:
                seen.add(included)
                waiting.append(included)
    return table


def _define(table: Table, element: Element, file: FilePath) -> str | None:
    """Store a macro or property; return the file of an include."""
    attributes = element.attributes
    if element.command == "macro":
        macro = grab_macro(element, file)
        table.macros[macro.name] = macro
    elif element.command == "property" and "value" in attributes:
        table.set(attributes.get("name", ""), attributes["value"], lazy=True)
    elif element.command == "property":
        table.blocks[attributes.get("name", "")] = Block(tuple(element.children), None, file)
    elif element.command == "include" and "ns" not in attributes:
        return attributes.get("filename")
    return None


def _commands(root: Element) -> Iterator[Element]:
    """Yield the elements that are not part of a macro, in the order of the file."""
    waiting = [root]
    while waiting:
        element = waiting.pop()
        yield element
        if element.command != "macro":
            waiting.extend(reversed(list(element.elements())))


_MOST_LEVELS: Final = 120
"""Of elements, macros and includes in one another, each of which takes frames of the interpreter's stack."""
_PLUGIN: Final = "plugin"
_AROUND: Final = frozenset({"sensor", "camera", "topic"})
"""Elements whose attributes and texts say something of the plugins near them."""
_COMMANDS: Final = frozenset({"property", "macro", "include", "insert_block", "if", "unless", "arg", "attribute"})


@dataclass(slots=True)
class Output:
    """An element of the description that has or is a plugin; `file`, `line` and `steps` are its place.

    `steps` are the places of the includes and calls of macros that led to it.
    """

    tag: str
    attributes: dict[str, str]
    file: FilePath
    line: int
    steps: tuple[tuple[FilePath, int], ...]
    conditions: tuple[str, ...]
    text: str = ""
    children: list[Output] = field(default_factory=list)


@dataclass(frozen=True, slots=True)
class Trouble:
    """Something wrong in a description, or not known."""

    kind: LaunchProblemKind
    message: str
    file: FilePath
    line: int
    steps: tuple[tuple[FilePath, int], ...]
    subject: str | None = None


@dataclass(frozen=True, slots=True)
class Description:
    """The result of a description: elements with plugins in them, problems, and the files that were read."""

    elements: tuple[Output, ...] = ()
    troubles: tuple[Trouble, ...] = ()
    files: tuple[FilePath, ...] = ()


@dataclass(frozen=True, slots=True)
class _At:
    """The state at an element: the scope, the file, and the way there."""

    table: Table
    file: FilePath
    steps: tuple[tuple[FilePath, int], ...] = ()
    conditions: tuple[str, ...] = ()
    depth: int = 0
    inside: bool = False
    """In a plugin, of which everything counts."""
    open: tuple[str, ...] = ()
    """The macros that are expanded; an element of such a name without prefix is not a call."""


def evaluate_description(
    files: Files, file: FilePath, arguments: Mapping[str, str], environment: Mapping[str, str]
) -> Description:
    """Return the plugins of the description in a file, evaluated with these arguments. Never raises.

    Texts of arguments may have `{}` for what is not known.
    """
    evaluation = _Evaluation(files, file, arguments, environment)
    try:
        evaluation.run(file)
    except RecursionError:
        evaluation.trouble(LaunchProblemKind.LIMIT, "the description is nested too deep to be read", file, 1)
    return evaluation.description()


class _Evaluation:
    """One evaluation of a description and its includes."""

    def __init__(
        self, files: Files, file: FilePath, arguments: Mapping[str, str], environment: Mapping[str, str]
    ) -> None:
        self._loading = Loading(files)
        around = Around({name: text.replace(ANONYMOUS, HOLE) for name, text in arguments.items()}, files.folder(file))
        self._files = files
        self._texts = Texts(Substituter(files, environment), around, self._yaml)
        self._texts.early = self._early
        self._outputs: list[Output] = []
        self._troubles: dict[tuple[LaunchProblemKind, str, FilePath, int], Trouble] = {}
        self._elements = 0
        self._root = file
        self._later: Table | None = None

    def _early(self) -> Table:
        """Return all definitions, collected on first use."""
        if self._later is None:
            # An empty table while it is filled: names of included files may ask for later definitions themselves.
            self._later = Table(self._texts.value)
            self._later = collect(self._root, self._files, self._loading, self._texts)
        return self._later

    def run(self, file: FilePath) -> None:
        """Evaluate the file that is named."""
        self._outputs = list(self._file(_At(Table(self._texts.value), file), file, 1))

    def description(self) -> Description:
        """Return the result."""
        return Description(tuple(self._outputs), tuple(self._troubles.values()), tuple(self._loading.read))

    def trouble(  # noqa: PLR0913, PLR0917 - the fields of a problem
        self,
        kind: LaunchProblemKind,
        message: str,
        file: FilePath,
        line: int,
        steps: tuple[tuple[FilePath, int], ...] = (),
        subject: str | None = None,
    ) -> None:
        """Note a problem, each once."""
        trouble = Trouble(kind, shown(message), file, line, steps, subject and shown(subject))
        self._troubles.setdefault((kind, message, file, line), trouble)

    def _file(self, at: _At, file: FilePath, line: int) -> Iterator[Output]:
        data = self._loading.data(file)
        if data is None:
            self.trouble(LaunchProblemKind.LIMIT, f"the file {file.path} is not read", at.file, line, at.steps)
            return
        document = DESCRIPTION.read(data)
        if document.problem is not None:
            self.trouble(LaunchProblemKind.MALFORMED, *document.problem[:1], file, document.problem[1], at.steps)
        if document.root is None:
            return
        before, self._texts.around.folder = self._texts.around.folder, self._files.folder(file)
        inner = replace(at, file=file)
        yield from self._children(inner, document.root.children, None)
        self._texts.around.folder = before

    def _children(self, at: _At, children: Iterable[Element | str], parent: Output | None) -> Iterator[Output]:
        """Yield the results of the elements; texts, and commands about the parent, change that."""
        for child in children:
            if isinstance(child, str):
                if parent is not None:
                    parent.text += self._texts.text(child, at.table)
                continue
            self._elements += 1
            if self._elements > _MOST_ELEMENTS or at.depth > _MOST_LEVELS:
                message = f"the description has more than {_MOST_ELEMENTS} elements, or {_MOST_LEVELS} levels"
                self.trouble(LaunchProblemKind.LIMIT, message, at.file, 1)
                return
            deeper = replace(at, depth=at.depth + 1)
            yield from self._one(deeper, child, parent)

    def _one(self, at: _At, element: Element, parent: Output | None) -> Iterator[Output]:
        command = element.command
        if command in _COMMANDS:
            yield from getattr(self, f"_do_{command}")(at, element, parent)
        elif command == "element":
            name = self._texts.text(element.attributes.get("xacro:name", ""), at.table)
            others = {key: text for key, text in element.attributes.items() if key != "xacro:name"}
            yield from self._plain(at, Element(name, others, element.line, element.children))
        elif (call := self._call(at, element, command)) is not None:
            yield from self._expand(at, element, call, parent)
        elif command is None:
            yield from self._plain(at, element)

    def _plain(self, at: _At, element: Element) -> Iterator[Output]:
        is_plugin = element.tag == _PLUGIN and "filename" in element.attributes
        inside = at.inside or is_plugin
        says = inside or element.tag in _AROUND
        attributes = {key: self._texts.text(text, at.table) for key, text in element.attributes.items()} if says else {}
        output = Output(element.tag, attributes, at.file, element.line, at.steps, at.conditions)
        within = replace(at, inside=inside)
        output.children = list(self._children(within, element.children, output if says else None))
        if says or output.children:
            yield output

    def _call(self, at: _At, element: Element, command: str | None) -> tuple[Macro, Table] | None:
        """Return the macro that an element calls; without prefix only if it can be nothing else."""
        name = element.tag if command is None else command
        if command == "call":
            name = self._texts.text(element.attributes.get("macro", ""), at.table)
        match = at.table.macro(name)
        if command is not None or match is None:
            later = self._early().macro(name) if match is None and command is not None else None
            return match or (later and (later[0], at.table))
        macro, _ = match
        needed = {name for name, default in macro.parameters.items() if default is None and not name.startswith("*")}
        given = element.attributes.keys()
        fits = needed <= given <= macro.parameters.keys() and (needed or not element.children)
        return match if fits and not at.inside and macro.name not in at.open else None

    def _expand(self, at: _At, element: Element, call: tuple[Macro, Table], parent: Output | None) -> Iterator[Output]:
        macro, around = call
        blocks = [
            Block((one,), at.table, at.file) for one in self._flat(at, element.children) if isinstance(one, Element)
        ]
        scope = called(macro, around, (element, at.table), blocks, self._texts)
        steps = (*at.steps, (at.file, element.line))
        inside = replace(at, table=scope, file=macro.file, steps=steps, open=(*at.open, macro.name))
        yield from self._children(inside, macro.body.children, parent)

    def _flat(self, at: _At, children: Iterable[Element | str]) -> Iterator[Element | str]:
        """Yield children with those of conditions that hold in their place."""
        for child in children:
            if isinstance(child, Element) and child.command in {"if", "unless"}:
                if self._holds(at, child)[0]:
                    yield from self._flat(at, child.children)
            else:
                yield child

    def _holds(self, at: _At, element: Element) -> tuple[bool, str | None]:
        """Return whether a condition holds, or may; then also its words."""
        written, wanted = element.attributes.get("value", ""), element.command == "if"
        try:
            return truth(self._texts.value(written, at.table)) is wanted, None
        except UnknownValueError:
            return True, written if wanted else f"not {written}"
        except ValueError:
            message = f"the condition '{written}' is neither true nor false"
            self.trouble(LaunchProblemKind.MALFORMED, message, at.file, element.line, at.steps)
            return True, written

    def _do_if(self, at: _At, element: Element, parent: Output | None) -> Iterator[Output]:
        holds, words = self._holds(at, element)
        if holds:
            conditions = at.conditions if words is None else (*at.conditions, words)
            inner = replace(at, conditions=conditions)
            yield from self._children(inner, element.children, parent)

    _do_unless = _do_if

    def _do_macro(self, at: _At, element: Element, _: Output | None) -> tuple[()]:
        macro = grab_macro(element, at.file)
        at.table.macros[macro.name] = macro
        return ()

    def _do_property(self, at: _At, element: Element, _: Output | None) -> tuple[()]:
        name = self._texts.text(element.attributes.get("name", ""), at.table)
        given = {key: element.attributes.get(key) for key in ("value", "default", "scope", "lazy_eval", "remove")}
        if given["remove"] in {"true", "True", "1"}:
            at.table.drop(name)
        elif given["default"] is not None:
            if name not in at.table:
                at.table.set(name, given["default"], lazy=True)
        elif given["value"] is None:
            at.table.blocks[name] = Block(tuple(element.children), None, at.file)
        else:
            value = given["value"]
            target = {"global": at.table.top(), "parent": at.table.caller()}.get(given["scope"] or "", at.table)
            lazy = target is at.table and (given["lazy_eval"] or "true") not in {"false", "False", "0"}
            if target is not None:
                target.set(name, value if lazy else self._texts.value(value, at.table), lazy=lazy)
        return ()

    def _do_arg(self, at: _At, element: Element, _: Output | None) -> tuple[()]:
        name, default = element.attributes.get("name"), element.attributes.get("default")
        arguments = self._texts.around.arguments
        if name is not None and default is not None and name not in arguments:
            arguments[name] = self._texts.text(default, at.table)
        return ()

    def _do_attribute(self, at: _At, element: Element, parent: Output | None) -> tuple[()]:
        if parent is not None:
            name, text = (self._texts.text(element.attributes.get(key, ""), at.table) for key in ("name", "value"))
            parent.attributes[name] = text
        return ()

    def _do_insert_block(self, at: _At, element: Element, parent: Output | None) -> Iterator[Output]:
        name = self._texts.text(element.attributes.get("name", ""), at.table)
        block = at.table.block(name) or self._early().block(name)
        if block is not None:
            inner = replace(at, table=block.scope or at.table, file=block.file)
            yield from self._children(inner, block.elements, parent)

    def _do_include(self, at: _At, element: Element, _: Output | None) -> Iterator[Output]:
        written = self._texts.text(element.attributes.get("filename", ""), at.table)
        space = element.attributes.get("ns")
        table = at.table
        if space:
            table = Table(self._texts.value, at.table, spaced=True)
            at.table.set(self._texts.text(space, at.table), table)
        optional = element.attributes.get("optional") in {"true", "True", "1"}
        match = self._loading.find(written, self._texts.around.folder)
        if match.reason is not None and not optional:
            self.trouble(match.kind, match.reason, at.file, element.line, at.steps, match.subject)
        file = match.file
        if file is not None and (file == at.file or any(file == step for step, _ in at.steps)):
            message = f"{file.path} includes itself"
            self.trouble(LaunchProblemKind.CYCLE, message, at.file, element.line, at.steps, file.path)
        elif file is not None:
            steps = (*at.steps, (at.file, element.line))
            yield from self._file(replace(at, table=table, steps=steps), file, element.line)

    def _yaml(self, written: object) -> object:
        return self._loading.yaml(str(written), self._texts.around.folder)
