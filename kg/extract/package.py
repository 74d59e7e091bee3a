"""The assembly of a package's facts: every reader is called once, and what they say becomes one `PackageFacts`.

`extract_package` is a pure function of the files of the package and of those that they include, so that it can run in
any process of a pool, or on another machine. A defect in one reader costs that reader's facts of that package only.
"""

from __future__ import annotations

import traceback
from collections import Counter
from dataclasses import dataclass, replace
from pathlib import Path, PurePosixPath
from typing import TYPE_CHECKING, Final, TypeVar

from kg.corpus.reading import DEFAULT_LIMIT_BYTES, Reader
from kg.extract import cpp, definitions, implicit, launch, manifests, parameters, python, texts
from kg.extract.buildmodel import BuildModel, TargetKind
from kg.extract.merging import merge, settled
from kg.facts import Location, Package, PackageFacts, SourceFile
from kg.symbolic.descriptions import merged

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

    from kg.corpus.files import PackageFolder, Source
    from kg.corpus.workspace import Workspace
    from kg.extract.marks import Extracted
    from kg.facts import InterfaceDefinition, NodeType

__all__ = ["ExtractSettings", "extract_package"]

_Result = TypeVar("_Result")
_ROS_UNKNOWN: Final = 0


@dataclass(frozen=True, slots=True)
class ExtractSettings:
    """Settings of extraction.

    `max_file_bytes` is the size in bytes above which a file is reported and not read, `calls` are the texts of the
    users' descriptions of framework calls, without errors (`kg.symbolic.checking`).
    """

    max_file_bytes: int = DEFAULT_LIMIT_BYTES
    calls: tuple[str, ...] = ()


def extract_package(
    workspace: Workspace, source: Source, package: PackageFolder, settings: ExtractSettings | None = None
) -> PackageFacts:
    """Return all that the files of `package` say; it raises nothing, what went wrong stands in `problems`."""
    limits = settings or ExtractSettings()
    reader = Reader(workspace, source, package, limits.max_file_bytes)
    described = _guard(reader, manifests.read_manifest, _undescribed(package), reader, package)
    build = _guard(reader, manifests.read_build, BuildModel(), reader, package)
    no_definitions: tuple[InterfaceDefinition, ...] = ()
    nodes = _nodes(reader, package, build, limits.calls)
    return PackageFacts(
        repository=source.repository.name,
        package=described,
        nodes=nodes,
        definitions=tuple(
            sorted(
                _guard(reader, definitions.read_definitions, no_definitions, reader, package),
                key=lambda definition: (definition.kind, definition.name, definition.location.path),
            )
        ),
        files=tuple(_files(reader, package)),
        launches=_guard(reader, launch.read_launches, (), reader, package, described.ros),
        descriptions=_guard(reader, texts.read_descriptions, (), reader, package, build, nodes),
        # Last, as reading adds to both.
        problems=tuple(sorted(reader.problems, key=lambda found: (found.path, found.line or 0, found.code))),
        inputs=reader.inputs,
        programs=_programs(package, build, nodes),
    )


def _programs(package: PackageFolder, build: BuildModel, nodes: tuple[NodeType, ...]) -> tuple[str, ...]:
    """Return what can be started by name: what is built or installed, and files that may be executed where they are.

    The classes that are registered, and in which no node was found, are among them.
    """
    classes = {one.name for one in build.plugins} - {one.plugin for one in nodes}
    built = (one.output_name or one.name for one in build.targets if one.kind is not TargetKind.LIBRARY)
    alone = (one.executable for one in build.plugins if one.executable)
    installed = [*(one.name for one in build.scripts), *(one.name for one in build.entry_points)]
    files = (PurePosixPath(entry.path).name for entry in package.files if entry.executable)
    return tuple(sorted({*built, *alone, *installed, *build.programs, *files, *classes}))


def _nodes(reader: Reader, package: PackageFolder, build: BuildModel, calls: tuple[str, ...]) -> tuple[NodeType, ...]:
    nothing: list[Extracted] = []
    read = [
        *_guard(reader, cpp.read_nodes, nothing, reader, package, build, merged(calls)),
        *_guard(reader, python.read_nodes, nothing, reader, package, build, merged(calls, "python")),
    ]
    whole = merge(read)
    complete = _guard(reader, parameters.attach, whole, reader, package, build, whole)
    found = settled(_guard(reader, implicit.add, extracted.node, extracted) for extracted in complete)
    return tuple(replace(node, aliases=_aliases(node, build)) for node in found)


def _aliases(node: NodeType, build: BuildModel) -> tuple[str, ...]:
    """Return the other executables of a node, its target, and the library that it is the only plugin of."""
    targets = {t.name for t in build.targets if node.executable is not None and t.output_name == node.executable}
    libraries = Counter(plugin.library for plugin in build.plugins)
    own = {plugin.library for plugin in build.plugins if node.plugin is not None and plugin.name == node.plugin}
    alone = {PurePosixPath(library).name.removeprefix("lib") for library in own if library and libraries[library] == 1}
    return tuple(sorted(({*node.aliases} | targets | alone) - {node.name, node.executable or ""}))


def _guard(reader: Reader, read: Callable[..., _Result], instead: _Result, *arguments: object) -> _Result:
    """Return what `read` makes of its arguments, or `instead` and a problem KG121 when it has a defect."""
    try:
        return read(*arguments)
    except Exception as error:  # noqa: BLE001 - whatever a reader trips over must not cost the other readers' facts
        frame = traceback.extract_tb(error.__traceback__)[-1]
        place = f"{Path(frame.filename).name}:{frame.lineno} in {frame.name}"
        name = f"{read.__module__.removeprefix('kg.extract.')}.{read.__name__}"
        message = f"{name}: {type(error).__name__}: {error} ({place})"
        reader.problem("KG121", message, reader.package.manifest or reader.package.path)
        return instead


def _undescribed(package: PackageFolder) -> Package:
    """Return what the scan alone knows of a package."""
    return Package(package.name, package.path, _ROS_UNKNOWN, Location(package.manifest or package.path, 1))


def _files(reader: Reader, package: PackageFolder) -> Iterator[SourceFile]:
    """Yield the files of the package that could be read, by path."""
    ordered = sorted(package.files, key=lambda entry: entry.path)
    readable = [entry for entry in ordered if reader.read(entry.path) is not None]
    digests = dict(reader.inputs)
    for entry in readable:
        yield SourceFile(entry.path, entry.kind, entry.bytes, digests[f"{reader.repository}:{entry.path}"])
