"""setup.py, setup.cfg and pyproject.toml: entry points and scripts. Nothing in them is ever run."""

from __future__ import annotations

import configparser
import posixpath
import re
import tomllib
from dataclasses import dataclass, field
from functools import cache
from typing import TYPE_CHECKING, Final

from kg.extract.buildmodel import EntryPoint, Script
from kg.facts import Location
from kg.holes import ANONYMOUS

if TYPE_CHECKING:
    from collections.abc import Iterator

    from tree_sitter import Node, Parser

    from kg.corpus.files import PackageFolder
    from kg.corpus.reading import Reader

__all__ = ["Piece", "Values", "read_setup"]

_DEEPEST: Final = 60


@dataclass(frozen=True, slots=True)
class Piece:
    """A string with the line it stands on."""

    text: str
    line: int


Value = "Piece | list[Value] | dict[str, Value] | None"


class Values:
    """Evaluates expressions against the names that a module assigns at its top level."""

    def __init__(self) -> None:
        self.names: dict[str, object] = {}
        self._depth = 0

    def of(self, node: Node | None) -> object:
        """Return a `Piece`, a list, a dict of strings, or None for what is not known."""
        if node is None or self._depth > _DEEPEST:
            return None
        self._depth += 1
        try:
            return self._evaluate(node)
        finally:
            self._depth -= 1

    def _evaluate(self, node: Node) -> object:
        match node.type:
            case "string":
                return self._string(node)
            case "concatenated_string":
                return self._join([self.of(child) for child in node.named_children], node)
            case "identifier":
                return self.names.get(text_of(node))
            case "list" | "tuple" | "set":
                return [item for child in node.named_children for item in self._items(child)]
            case "dictionary":
                return self._dictionary(node)
            case "parenthesized_expression" | "list_splat":
                return self.of(node.named_children[0]) if node.named_children else None
            case "binary_operator":
                return self._binary(node)
            case "call":
                return self._call(node)
            case "list_comprehension":
                return self._comprehension(node)
        return None

    def _items(self, node: Node) -> list[object]:
        value = self.of(node)
        if node.type == "list_splat":
            return value if isinstance(value, list) else []
        return [value]

    def _string(self, node: Node) -> Piece:
        parts: list[str] = []
        for child in node.named_children:
            if child.type == "string_content":
                parts.append(_unescaped(text_of(child)))
            elif child.type == "interpolation" and child.named_children:
                value = self.of(child.named_children[0])
                parts.append(value.text if isinstance(value, Piece) else ANONYMOUS)
        return Piece("".join(parts), node.start_point[0] + 1)

    def _join(self, values: list[object], node: Node) -> Piece | None:
        pieces = [value.text for value in values if isinstance(value, Piece)]
        return Piece("".join(pieces), node.start_point[0] + 1) if len(pieces) == len(values) else None

    def _dictionary(self, node: Node) -> dict[str, object]:
        found: dict[str, object] = {}
        for pair in node.named_children:
            if pair.type == "pair":
                key = self.of(pair.child_by_field_name("key"))
                if isinstance(key, Piece):
                    found[key.text] = self.of(pair.child_by_field_name("value"))
        return found

    def _binary(self, node: Node) -> object:
        left, right = self.of(node.child_by_field_name("left")), self.of(node.child_by_field_name("right"))
        operator = node.child_by_field_name("operator")
        sign = text_of(operator) if operator else ""
        if sign == "+":
            if isinstance(left, list) or isinstance(right, list):
                return [*(left if isinstance(left, list) else []), *(right if isinstance(right, list) else [])]
            return self._join([left, right], node)
        if sign == "%" and isinstance(left, Piece):
            values = right if isinstance(right, list) else [right]
            return _fill(left, "%s", values)
        return None

    def _call(self, node: Node) -> object:
        function = node.child_by_field_name("function")
        arguments = node.child_by_field_name("arguments")
        values = [self.of(child) for child in arguments.named_children] if arguments else []
        if function is None or function.type != "attribute":
            return values[0] if function is not None and text_of(function) in {"list", "str"} and values else None
        owner = self.of(function.child_by_field_name("object"))
        name = function.child_by_field_name("attribute")
        if isinstance(owner, Piece) and name is not None and text_of(name) == "format":
            return _fill(owner, "{}", values)
        return None

    def _comprehension(self, node: Node) -> list[object]:
        """Evaluate `[f"{x} = ..." for x in [...]]` for one loop over a known list."""
        loops = [child for child in node.named_children if child.type == "for_in_clause"]
        body = node.child_by_field_name("body")
        if len(loops) != 1 or body is None:
            return []
        left, right = loops[0].child_by_field_name("left"), self.of(loops[0].child_by_field_name("right"))
        if left is None or left.type != "identifier" or not isinstance(right, list):
            return []
        name, before = text_of(left), dict(self.names)
        found = []
        for item in right:
            self.names[name] = item
            found.append(self.of(body))
        self.names = before
        return found


def text_of(node: Node) -> str:
    """Return the text of a node."""
    return (node.text or b"").decode("utf-8", "replace")


def _unescaped(content: str) -> str:
    """Return the content of a string literal with its escapes undone; only those that entry points can have."""
    for written, meant in (("\\\n", ""), ("\\n", "\n"), ("\\t", "\t"), ("\\'", "'"), ('\\"', '"')):
        content = content.replace(written, meant)
    return content


def _fill(template: Piece, mark: str, values: list[object]) -> Piece | None:
    text = template.text
    for value in values:
        if not isinstance(value, Piece):
            return None
        text = text.replace(mark, value.text, 1)
    return Piece(text, template.line)


_SETUP_CALLS: Final = frozenset({"setup", "generate_distutils_setup", "dict", "generate_parameter_module"})
_ENTRY: Final = re.compile(r"^\s*([^\s=]+)\s*=\s*([\w.]+)\s*(?::\s*([\w.]+))?")


@dataclass(slots=True)
class Setup:
    """What the Python side of a package declares; parameter modules pair a module with its YAML file."""

    entry_points: dict[str, EntryPoint] = field(default_factory=dict)
    scripts: dict[str, Script] = field(default_factory=dict)
    parameter_modules: dict[tuple[str, str], None] = field(default_factory=dict)


def read_setup(reader: Reader, folder: PackageFolder) -> Setup:
    """Return the console scripts, scripts and parameter modules that a package declares."""
    found = _Found(reader, folder)
    for name, read in (("setup.py", _setup_py), ("setup.cfg", _setup_cfg), ("pyproject.toml", _pyproject)):
        path = folder.join(name)
        if reader.workspace.entry(reader.file(path)):
            text = reader.read(path)
            if text is not None:
                read(found, path, text)
    return found.setup


class _Found:
    """Collects entry points and scripts, the first of a name counts."""

    def __init__(self, reader: Reader, folder: PackageFolder) -> None:
        self.reader = reader
        self.folder = folder
        self.roots = ["", "src", "python", "scripts"]
        self.setup = Setup()

    def entry(self, written: str, path: str, line: int) -> None:
        """Take an entry point as written: `name = package.module:function`."""
        match = _ENTRY.match(written)
        if match:
            name, module, function = match[1], match[2], match[3] or ""
            point = EntryPoint(name, module, function, self._module(module, path), Location(path, line))
            self.setup.entry_points.setdefault(name, point)

    def script(self, written: str, path: str, line: int) -> None:
        """Take a file of `scripts=`."""
        file = posixpath.normpath(self.folder.join(written))
        if self.reader.workspace.entry(self.reader.file(file)):
            name = posixpath.basename(file)
            self.setup.scripts.setdefault(name, Script(name, file, Location(path, line)))

    def parameter_module(self, module: str, written: str) -> None:
        """Take a YAML file that generate_parameter_library makes a module of."""
        file = posixpath.normpath(self.folder.join(written))
        if self.reader.workspace.entry(self.reader.file(file)):
            self.setup.parameter_modules[(module, file)] = None

    def _module(self, module: str, path: str) -> str | None:
        relative = module.replace(".", "/")
        for root in self.roots:
            stem = posixpath.normpath(self.folder.join(posixpath.join(root, relative)))
            for candidate in (f"{stem}.py", f"{stem}/__init__.py"):
                if self.reader.workspace.entry(self.reader.file(candidate)):
                    return candidate
        found = self.reader.workspace.module(module, near=self.reader.file(path))
        return found.path if found and found.repository == self.reader.repository else None


@cache
def _parser() -> Parser:
    import tree_sitter_python  # noqa: PLC0415  (the command line starts without it)
    from tree_sitter import Language, Parser  # noqa: PLC0415  (the same)

    return Parser(Language(tree_sitter_python.language()))


def _setup_py(found: _Found, path: str, text: bytes) -> None:
    tree = _parser().parse(text)
    if tree.root_node.has_error:
        line = _first_error(tree.root_node)
        found.reader.problem("KG115", "part of setup.py does not parse", path, line)
    values = Values()
    for keywords, positional in _setup_calls(tree.root_node, values):
        match [values.of(node) for node in positional[:2]]:
            case [Piece(text=module), Piece(text=written)]:
                found.parameter_module(module, written)
        _package_dir(found, values.of(keywords.get("package_dir")))
        _entry_points(found, values.of(keywords.get("entry_points")), path)
        scripts = values.of(keywords.get("scripts"))
        for item in scripts if isinstance(scripts, list) else ():
            if isinstance(item, Piece):
                found.script(item.text, path, item.line)


def _first_error(root: Node) -> int:
    """Return the line of the first error, going down only into what holds one."""
    node = root
    while True:
        inner = next((child for child in node.children if child.has_error or child.is_missing), None)
        if inner is None or node.is_error:
            return node.start_point[0] + 1
        node = inner


def _setup_calls(root: Node, values: Values) -> Iterator[tuple[dict[str, Node], list[Node]]]:
    """Yield the arguments, by keyword and others, of calls that set up a package.

    The assignments before a call are known by then.
    """
    pending = list(reversed(root.named_children))
    while pending:
        node = pending.pop()
        if node.type == "assignment":
            left, right = node.child_by_field_name("left"), node.child_by_field_name("right")
            if left is not None and left.type == "identifier":
                values.names[text_of(left)] = values.of(right)
        if node.type == "call":
            function = node.child_by_field_name("function")
            name = text_of(function).rpartition(".")[2] if function is not None else ""
            arguments = node.child_by_field_name("arguments")
            if name in _SETUP_CALLS and arguments is not None:
                positional = [child for child in arguments.named_children if child.type != "keyword_argument"]
                yield dict(_keywords(arguments)), positional
        elif node.type in {
            "expression_statement",
            "assignment",
            "if_statement",
            "block",
            "try_statement",
            "else_clause",
        }:
            pending.extend(reversed(node.named_children))


def _keywords(arguments: Node) -> Iterator[tuple[str, Node]]:
    for child in arguments.named_children:
        name, value = child.child_by_field_name("name"), child.child_by_field_name("value")
        if child.type == "keyword_argument" and name is not None and value is not None:
            yield text_of(name), value


def _package_dir(found: _Found, value: object) -> None:
    if isinstance(value, dict):
        found.roots[:0] = [piece.text for piece in value.values() if isinstance(piece, Piece)]


def _entry_points(found: _Found, value: object, path: str) -> None:
    if isinstance(value, Piece):
        _ini_entry_points(found, value.text, path, value.line)
        return
    listed = value.get("console_scripts") if isinstance(value, dict) else None
    if isinstance(listed, Piece):
        for offset, written in enumerate(listed.text.splitlines()):
            found.entry(written, path, listed.line + offset)
    for item in listed if isinstance(listed, list) else ():
        if isinstance(item, Piece):
            found.entry(item.text, path, item.line)


def _ini_entry_points(found: _Found, text: str, path: str, line: int) -> None:
    section = ""
    for offset, written in enumerate(text.splitlines()):
        if written.strip().startswith("["):
            section = written.strip(" []\t")
        elif section == "console_scripts":
            found.entry(written, path, line + offset)


def _setup_cfg(found: _Found, path: str, text: bytes) -> None:
    config = configparser.RawConfigParser(strict=False, allow_no_value=True)
    try:
        config.read_string(text.decode())
    except configparser.Error as error:
        found.reader.problem("KG115", f"setup.cfg does not parse: {error.message.splitlines()[0]}", path)
        return
    lines = text.decode().splitlines()
    listed = config.get("options.entry_points", "console_scripts", fallback=None) or ""
    for written in listed.splitlines():
        found.entry(written, path, _line_of(lines, written))
    for written in (config.get("options", "scripts", fallback=None) or "").splitlines():
        if written.strip():
            found.script(written.strip(), path, _line_of(lines, written))


def _line_of(lines: list[str], written: str) -> int:
    return next((number for number, line in enumerate(lines, 1) if written.strip() and written.strip() in line), 1)


def _pyproject(found: _Found, path: str, text: bytes) -> None:
    try:
        project = tomllib.loads(text.decode()).get("project", {})
    except (tomllib.TOMLDecodeError, RecursionError) as error:
        found.reader.problem("KG115", f"pyproject.toml does not parse: {error}", path)
        return
    scripts = project.get("scripts") if isinstance(project, dict) else None
    lines = text.decode().splitlines()
    for name, written in scripts.items() if isinstance(scripts, dict) else ():
        found.entry(f"{name} = {written}", path, _line_of(lines, str(written)))
