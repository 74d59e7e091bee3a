"""Manifests and build files: the metadata of a package, and which files make which node."""

from __future__ import annotations

from typing import TYPE_CHECKING

from kg.extract.buildmodel import BuildModel, PluginClass
from kg.extract.manifests.cargo import read_cargo
from kg.extract.manifests.cmake import read_cmake, valued
from kg.extract.manifests.package_xml import read_package_xml
from kg.extract.manifests.plugin_xml import exported_files, read_plugin_file
from kg.extract.manifests.scripts import read_scripts
from kg.extract.manifests.setup_py import read_setup
from kg.facts import FileKind, Package

if TYPE_CHECKING:
    from kg.corpus.files import PackageFolder
    from kg.corpus.reading import Reader

__all__ = ["read_build", "read_manifest"]


def read_manifest(reader: Reader, package: PackageFolder) -> Package:
    """Return the manifest of a package; problems go to the reader."""
    return read_package_xml(reader, package).package


def read_build(reader: Reader, package: PackageFolder) -> BuildModel:
    """Return the declarations of the build files of a package; problems go to the reader."""
    manifest = read_package_xml(reader, package)
    collected = read_cmake(reader, package, manifest.package)
    targets = collected.finished()
    found: dict[tuple[str, str | None], PluginClass] = {}
    for path in exported_files(package, manifest.exports, collected.plugin_files):
        for plugin in read_plugin_file(reader, path, targets):
            found.setdefault((plugin.name, plugin.base_type), plugin)
    plugins = collected.run_alone([*collected.plugins, *found.values()])
    setup = read_setup(reader, package)
    # Of dynamic_reconfigure are also the files of the folder `cfg` that CMake does not list.
    folder = package.join("cfg/")
    configurations = (entry.path for entry in package.files if entry.kind is FileKind.CONFIG)
    own = (path for path in configurations if path.startswith(folder) and path.endswith(".cfg"))
    scripts = read_scripts(reader, package, collected.programs, setup.scripts.values())
    return BuildModel(
        targets=collected.finished(),
        plugins=tuple(plugins),
        scripts=tuple(scripts),
        entry_points=tuple(setup.entry_points.values()),
        programs=(*collected.program_names, *read_cargo(reader, package)),
        parameter_libraries=(*collected.parameter_libraries, *setup.parameter_modules),
        reconfigure_files=tuple(dict.fromkeys([*collected.reconfigure_files, *own])),
        ros=manifest.package.ros,
        absent=collected.absent,
        defined=tuple(sorted({*collected.common}.union(*(one.macros for one in collected.targets.values())))),
        values=valued(collected.common),
    )
