"""Manifests and build files: the metadata of a package, and which files make which node."""

from __future__ import annotations

from typing import TYPE_CHECKING

from kg.extract.buildmodel import BuildModel, PluginClass
from kg.extract.manifests.cmake import read_cmake
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
    scripts = read_scripts(reader, package, collected.programs, setup.scripts.values())
    reconfigure = dict.fromkeys([*collected.reconfigure_files, *_cfg_files(package)])
    return BuildModel(
        targets=collected.finished(),
        plugins=tuple(plugins),
        scripts=tuple(scripts),
        entry_points=tuple(setup.entry_points.values()),
        programs=tuple(collected.program_names),
        parameter_libraries=(*collected.parameter_libraries, *setup.parameter_modules),
        reconfigure_files=tuple(reconfigure),
        ros=manifest.package.ros,
        absent=collected.absent,
    )


def _cfg_files(package: PackageFolder) -> list[str]:
    """Return the files of the folder `cfg`, where dynamic_reconfigure has its own, whether CMake lists them or not."""
    folder = package.join("cfg/")
    return [
        e.path
        for e in package.files
        if e.kind is FileKind.CONFIG and e.path.startswith(folder) and e.path.endswith(".cfg")
    ]
