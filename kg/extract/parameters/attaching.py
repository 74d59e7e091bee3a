"""Which nodes have the parameters that are declared outside of code.

A library of `generate_parameter_library` belongs to the nodes that include its header (a mark), and to those whose
targets link it; a Python module of it to the scripts that import it. A configuration of dynamic_reconfigure belongs to
the nodes that make a server of it (a mark).
"""

from __future__ import annotations

import posixpath
from dataclasses import replace
from typing import TYPE_CHECKING, Final

from kg.corpus.files import FilePath
from kg.extract import manifests
from kg.extract.marks import Extracted, Mark
from kg.extract.parameters.generated import read_generated
from kg.extract.parameters.reconfigure import read_configuration
from kg.extract.python.syntax import captures, code, parse
from kg.facts import FileKind, Location, NodeKind, NodeType
from kg.names import join

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator

    from kg.corpus.files import PackageFolder
    from kg.corpus.reading import Reader
    from kg.extract.buildmodel import BuildModel, Target
    from kg.facts import Parameter

__all__ = ["attach"]

_LIBRARY: Final = "generate_parameter_library"
_SERVER: Final = "dynamic_reconfigure.server"
_ROS2: Final = 2


def attach(reader: Reader, package: PackageFolder, build: BuildModel, nodes: Iterable[Extracted]) -> list[Extracted]:
    """Return the nodes with the parameters that YAML and `.cfg` files declare for them.

    A library of the package that none of its nodes is seen to use is returned as a node of kind `class`, so that what
    it declares is not lost: other packages use it.
    """
    libraries = {target: read_generated(reader, path) for target, path in build.parameter_libraries}
    links = _Links(build.targets)
    complete, used = [], set()
    for extracted in nodes:
        linked = {
            target
            for target in libraries
            if links.reach(extracted.node, target) or _imports(reader, extracted.node, target)
        }
        prefixes = {mark.detail: mark.namespace for mark in extracted.marks if mark.key == _LIBRARY}
        own = [target for target in libraries if target in linked or target in prefixes]
        used.update(own)
        found = [
            *(_prefixed(parameter, prefixes.get(target, "")) for target in own for parameter in libraries[target]),
            *_foreign(reader, extracted.marks, libraries),
            *_reconfigured(reader, package, build, extracted.marks),
        ]
        node = replace(extracted.node, parameters=extracted.node.parameters + tuple(found))
        complete.append(replace(extracted, node=node))
    complete.extend(
        Extracted(_library_node(target, path, libraries[target], "cpp" if build.targets else "python"))
        for target, path in build.parameter_libraries
        if target not in used and libraries[target]
    )
    return complete


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


def _imports(reader: Reader, node: NodeType, module: str) -> bool:
    """Tell whether a Python node imports the module that is made of a parameter file."""
    for path in node.sources if node.language == "python" else ():
        content = reader.read(path)
        if content is None or module.encode() not in content:
            continue
        for statement in captures(parse(content).root_node).get("import", ()):
            names = [statement.child_by_field_name("module_name"), *statement.children_by_field_name("name")]
            if any(code(name).rpartition(".")[2] == module for name in names):
                return True
    return False


class _Links:
    """What the targets of a package link, directly and through each other."""

    def __init__(self, targets: tuple[Target, ...]) -> None:
        self._targets = {target.name: target for target in targets}
        self._by_source: dict[str, list[str]] = {}
        for target in targets:
            for source in target.sources:
                self._by_source.setdefault(source, []).append(target.name)

    def reach(self, node: NodeType, library: str) -> bool:
        """Tell whether a target that makes the node links the library."""
        starts = [name for source in node.sources for name in self._by_source.get(source, ())]
        open_names, seen = [node.executable or "", *starts], set[str]()
        while open_names:
            name = open_names.pop()
            if name == library:
                return True
            if name not in seen and name in self._targets:
                seen.add(name)
                open_names.extend(link.rpartition("::")[2] for link in self._targets[name].links)
        return False


def _prefixed(parameter: Parameter, prefix: str) -> Parameter:
    return replace(parameter, name=f"{prefix}{parameter.name}") if prefix else parameter


def _foreign(reader: Reader, marks: tuple[Mark, ...], own: dict[str, tuple[Parameter, ...]]) -> Iterator[Parameter]:
    """Yield the parameters of libraries of other packages, which a base class there brings in."""
    for mark in marks:
        if mark.key != _LIBRARY or mark.detail in own:
            continue
        here = reader.repository
        repository = mark.location.repository or here
        owner = reader.workspace.owner(FilePath(repository, mark.location.path))
        if owner is None or owner == reader.place or repository != here:
            continue
        libraries = dict(manifests.read_build(reader, reader.workspace.folder(owner)[1]).parameter_libraries)
        if mark.detail in libraries:
            found = read_generated(reader, libraries[mark.detail])
            yield from (_prefixed(parameter, mark.namespace) for parameter in found)


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
