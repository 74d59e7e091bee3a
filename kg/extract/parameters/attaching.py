"""Parameters that are declared outside of code: what their files say of them, and which nodes have them.

A node has the parameters of a YAML file of `generate_parameter_library` if its code constructs the generated class. In
C++ running the node shows this (see `kg.extract.parameters.listener`), in Python a construction in its sources. A
configuration of dynamic_reconfigure belongs to the nodes that make a server of it (a mark).
"""

from __future__ import annotations

import posixpath
from dataclasses import replace
from typing import TYPE_CHECKING, Final

from kg.corpus.files import FilePath
from kg.extract.marks import Extracted, Mark
from kg.extract.parameters.generated import parse_generated, read_generated
from kg.extract.parameters.reconfigure import read_configuration
from kg.extract.python.syntax import argument_nodes, captures, code, parse
from kg.facts import FileKind, Location, NodeKind, NodeType, Resolution
from kg.holes import is_partial
from kg.names import join

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator

    from kg.corpus.files import PackageFolder
    from kg.corpus.reading import Reader
    from kg.extract.buildmodel import BuildModel
    from kg.facts import Parameter

__all__ = ["attach"]

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
        found = [
            *(_declared(reader, parameter, libraries) for parameter in extracted.node.parameters),
            *_imported(reader, extracted.node, build),
            *_reconfigured(reader, package, build, extracted.marks),
        ]
        complete.append(replace(extracted, node=replace(extracted.node, parameters=tuple(found))))
    used = {parameter.location.path for extracted in complete for parameter in extracted.node.parameters}
    complete.extend(
        Extracted(_library_node(target, path, own[path], "cpp" if build.targets else "python"))
        for target, path in build.parameter_libraries
        if path not in used and own[path]
    )
    return complete


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
    found = captures(parse(content).root_node)
    names = {module}
    for statement in found.get("import", ()):
        for name in statement.children_by_field_name("name"):
            alias = name.child_by_field_name("alias")
            if alias is not None and code(name.child_by_field_name("name")).rpartition(".")[2] == module:
                names.add(code(alias))
    for call in found.get("call", ()):
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
        for parameter in read_configuration(reader, file).parameters if file else ():
            yield replace(parameter, name=join(mark.namespace, parameter.name or ""))


def _configuration_file(reader: Reader, package: PackageFolder, build: BuildModel, name: str | None) -> FilePath | None:
    """Return the `.cfg` file of the configuration `package/Name`, which bears its name by convention of the tool."""
    home, _, stem = (name or "").removesuffix("Config").rpartition("/")
    if not stem:
        return None
    if home in {"", package.name}:
        paths = [*build.reconfigure_files, *(entry.path for entry in package.files)]
        found = _named(paths, stem)
        return reader.file(found) if found else None
    elsewhere = reader.workspace.package(home)
    if elsewhere is None:
        return None
    found = _named((entry.path for entry in reader.workspace.files(elsewhere, FileKind.CONFIG)), stem)
    return FilePath(elsewhere.repository, found) if found else None


def _named(paths: Iterable[str], stem: str) -> str | None:
    return next((path for path in paths if posixpath.basename(path) == f"{stem}.cfg"), None)
