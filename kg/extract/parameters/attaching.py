"""Parameters that are declared outside of code: their files, and the nodes that have them.

A node has the parameters of a YAML file of `generate_parameter_library` if its code constructs the generated class. In
C++ running the node shows this (see `kg.extract.parameters.listener`), in Python a construction in its sources. A
configuration of dynamic_reconfigure belongs to the nodes that make a server of it (a mark).
"""

from __future__ import annotations

import json
import posixpath
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Final

import yaml

from kg.corpus.files import FilePath, PackageFolder
from kg.extract.marks import Extracted, Mark
from kg.extract.parameters.reconfigure import generates, read_configuration
from kg.extract.python.syntax import argument_nodes, captures, code, parse
from kg.facts import Access, FileKind, Location, NodeKind, NodeType, Parameter, Resolution
from kg.holes import escape, hole_of, is_partial
from kg.names import join
from kg.yamltext import Walk, YamlFault, compose_yaml

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator

    from kg.corpus.reading import Reader
    from kg.extract.buildmodel import BuildModel

_MAP: Final = "__map_"
_TEXT: Final = "tag:yaml.org,2002:str"
_NOT_DECLARED: Final = "none"
"""The type of a parameter that the file only documents: the node reads it in another way."""


@dataclass(frozen=True, slots=True)
class GeneratedLibrary:
    """The parameters of a YAML file, in its order, and the namespace of the class that declares them.

    `namespace` is empty if the file has not exactly one top key. `error` is why reading of the file stopped:
    a message and a line, which can be unknown.
    """

    namespace: str
    parameters: tuple[Parameter, ...]
    error: tuple[str, int | None] | None = None


def parse_generated(content: bytes, path: str) -> GeneratedLibrary:
    """Return what the YAML file at `path` declares; where it is malformed, what comes before the mistake."""
    parameters: list[Parameter] = []
    keys: list[str] = []
    error: tuple[str, int | None] | None = None
    try:
        root = compose_yaml(content.decode())
        keys += [str(key.value) for key, _ in root.value] if isinstance(root, yaml.MappingNode) else []
        parameters.extend(_Walk(path).parameters_of(root))
    except YamlFault as fault:
        error = (f"the file {fault.message}", fault.line)
    return GeneratedLibrary(keys[0] if len(keys) == 1 else "", tuple(parameters), error)


def read_generated(reader: Reader, path: str) -> tuple[Parameter, ...]:
    """Return the parameters of the YAML file at `path`; one that cannot be used is a problem KG119 of the `reader`."""
    content = reader.read(path)
    if content is None:
        return ()
    library = parse_generated(content, path)
    if library.error is not None:
        message, line = library.error
        reader.problem("KG119", message, path, line)
    return library.parameters


class _Walk(Walk):
    """One walk over a composed document."""

    def __init__(self, path: str) -> None:
        super().__init__()
        self._path = path

    def parameters_of(self, root: yaml.Node | None) -> Iterator[Parameter]:
        """Yield the parameters of a document: below its top key, which names a namespace of C++ and no parameter."""
        for _, value in self.pairs(root, 0):
            yield from self._below(value, (), 1)

    def _below(self, node: yaml.Node, names: tuple[str, ...], depth: int) -> Iterator[Parameter]:
        for key, value in self.pairs(node, depth):
            name = hole_of(key.value.removeprefix(_MAP)) if key.value.startswith(_MAP) else escape(key.value)
            leaf = {inner.value: content for inner, content in self.pairs(value, depth)}
            if isinstance(leaf.get("type"), yaml.ScalarNode):
                yield self._parameter(".".join((*names, name)), leaf, key.start_mark.line + 1)
            else:
                yield from self._below(value, (*names, name), depth + 1)

    def _parameter(self, name: str, leaf: dict[str, yaml.Node], line: int) -> Parameter:
        description = leaf.get("description")
        documented_only = leaf["type"].value == _NOT_DECLARED
        return Parameter(
            name=name,
            type=None if documented_only else leaf["type"].value.partition("_fixed_")[0],
            default=self._written(leaf["default_value"], 0) if "default_value" in leaf else None,
            access=Access.READ if documented_only else Access.DECLARE,
            location=Location(self._path, line),
            resolution=Resolution.PARTIAL if is_partial(name) else Resolution.LITERAL,
            reason="it has the values of another parameter in it" if is_partial(name) else None,
            description=description.value.strip() or None if isinstance(description, yaml.ScalarNode) else None,
        )

    def _written(self, node: yaml.Node, depth: int) -> str:
        """Return a value as YAML on one line."""
        self.visit(node, depth)
        if isinstance(node, yaml.SequenceNode):
            return f"[{', '.join(self._written(item, depth + 1) for item in node.value)}]"
        if isinstance(node, yaml.MappingNode):
            pairs = (f"{self._written(key, depth + 1)}: {self._written(value, depth + 1)}" for key, value in node.value)
            return f"{{{', '.join(pairs)}}}"
        quoted = isinstance(node, yaml.ScalarNode) and node.tag == _TEXT and bool(node.style)
        return json.dumps(node.value, ensure_ascii=False) if quoted else str(node.value)


_LISTENER: Final = b"ParamListener"
_SERVER: Final = "dynamic_reconfigure.server"
_ROS2: Final = 2


def attach(reader: Reader, package: PackageFolder, build: BuildModel, nodes: Iterable[Extracted]) -> list[Extracted]:
    """Return the nodes with the parameters that YAML and `.cfg` files declare for them.

    A library of the package that none of its nodes constructs is returned as a node of kind `class`, so that what
    it declares is not lost: other packages use it.
    """
    own = {path: read_generated(reader, path) for _, path in build.parameter_libraries}
    libraries = {FilePath(reader.repository, path): keys for path, keys in own.items()}
    complete = []
    for extracted in nodes:
        configured = tuple(_reconfigured(reader, package, build, extracted.marks))
        types = {parameter.name: parameter.type for parameter in configured}
        parameters = [
            *(_declared(reader, _typed(parameter, types), libraries) for parameter in extracted.node.parameters),
            *_imported(reader, extracted.node, build),
            *configured,
        ]
        complete.append(replace(extracted, node=replace(extracted.node, parameters=tuple(parameters))))
    used = {parameter.location.path for extracted in complete for parameter in extracted.node.parameters}
    complete.extend(
        Extracted(_library_node(target, path, own[path], "cpp" if build.targets else "python"))
        for target, path in build.parameter_libraries
        if path not in used and own[path]
    )
    return complete


def _typed(parameter: Parameter, types: dict[str | None, str | None]) -> Parameter:
    """Return a parameter with the type of its name, if the code shows none."""
    return parameter if parameter.type is not None else replace(parameter, type=types.get(parameter.name))


def _declared(reader: Reader, parameter: Parameter, libraries: dict[FilePath, tuple[Parameter, ...]]) -> Parameter:
    """Return a parameter with what the YAML file says of it, if its place is the line of a key there."""
    place, name = parameter.location, parameter.name or ""
    if not place.path.endswith((".yaml", ".yml")):
        return parameter
    file = FilePath(place.repository or reader.repository, place.path)
    if file not in libraries:
        libraries[file] = parse_generated(reader.read(file) or b"", place.path).parameters
    keys = [key for key in libraries[file] if key.location.line == place.line and f".{name}".endswith(f".{key.name}")]
    written = max(keys, key=lambda key: len(key.name or ""), default=None)
    if written is None:
        return parameter
    resolution = Resolution.PARTIAL if is_partial(name) else parameter.resolution
    return replace(written, name=name, location=place, resolution=resolution)


def _library_node(target: str, path: str, parameters: tuple[Parameter, ...], language: str) -> NodeType:
    return NodeType(
        name=target,
        kind=NodeKind.CLASS,
        language=language,
        ros=_ROS2,
        location=Location(path, 1),
        sources=(path,),
        parameters=parameters,
    )


def _imported(reader: Reader, node: NodeType, build: BuildModel) -> Iterator[Parameter]:
    """Yield the parameters of the modules made of YAML files whose class a Python node constructs."""
    for module, path in build.parameter_libraries if node.language == "python" else ():
        for source in node.sources:
            content = reader.read(source)
            if content is None or module.encode() not in content or _LISTENER not in content:
                continue
            for prefix in _listeners(content, module):
                for parameter in read_generated(reader, path):
                    yield replace(parameter, name=f"{prefix}{parameter.name}")


def _listeners(content: bytes, module: str) -> Iterator[str]:
    """Yield the prefixes of the listeners that a Python source constructs of a module: `module.ParamListener(node)`."""
    captured = captures(parse(content).root_node)
    names = {module}
    for statement in captured.get("import", ()):
        for name in statement.children_by_field_name("name"):
            alias = name.child_by_field_name("alias")
            if alias is not None and code(name.child_by_field_name("name")).rpartition(".")[2] == module:
                names.add(code(alias))
    for call in captured.get("call", ()):
        *outer, last = code(call.child_by_field_name("function")).split(".")
        if last == _LISTENER.decode() and outer and outer[-1] in names:
            given = [code(argument) for argument in argument_nodes(call)]
            prefix = next((one.partition("=")[2] for one in given if one.startswith("prefix=")), "")
            text = (prefix or (given[1] if len(given) > 1 else "")).strip("\"'")
            yield text if not text or text.endswith(".") else f"{text}."


def _reconfigured(
    reader: Reader, package: PackageFolder, build: BuildModel, marks: tuple[Mark, ...]
) -> Iterator[Parameter]:
    for mark in marks:
        file = _configuration_file(reader, package, build, mark.detail) if mark.key == _SERVER else None
        for parameter in read_configuration(reader, file) if file else ():
            yield replace(parameter, name=join(mark.namespace, parameter.name or ""))


def _configuration_file(reader: Reader, package: PackageFolder, build: BuildModel, name: str | None) -> FilePath | None:
    """Return the `.cfg` file of the configuration `package/Name`, which has its name, or generates it.

    A file also states the package that it generates for, which can be another one than its own.
    """
    home, _, stem = (name or "").removesuffix("Config").rpartition("/")
    if not stem:
        return None
    paths = [*build.reconfigure_files, *(entry.path for entry in package.files)]
    own = [reader.file(path) for path in paths if path.endswith(".cfg")]
    if home in {"", package.name}:
        return _named(own, stem) or _generating(reader, own, home, stem)
    elsewhere = reader.workspace.package(home)
    listed = reader.workspace.files(elsewhere, FileKind.CONFIG) if elsewhere is not None else ()
    others = [FilePath(elsewhere.repository, entry.path) for entry in listed if elsewhere is not None]
    return _named(others, stem) or _generating(reader, own, home, stem)


def _named(files: Iterable[FilePath], stem: str) -> FilePath | None:
    return next((file for file in files if posixpath.basename(file.path) == f"{stem}.cfg"), None)


def _generating(reader: Reader, files: Iterable[FilePath], home: str, stem: str) -> FilePath | None:
    return next((file for file in files if generates(reader, file, home, stem)), None)
