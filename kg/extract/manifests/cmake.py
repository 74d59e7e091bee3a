"""What the CMakeLists.txt of a package declares."""

from __future__ import annotations

import posixpath
from typing import TYPE_CHECKING, Final

from kg.extract.manifests.cmake_builtins import HANDLERS
from kg.extract.manifests.cmake_files import CMakeFiles
from kg.extract.manifests.cmake_run import BINARY, SOURCE, Run
from kg.extract.manifests.cmake_scope import Scope
from kg.extract.manifests.cmake_targets import Collected, target_handlers

if TYPE_CHECKING:
    from kg.corpus.files import PackageFolder
    from kg.corpus.reading import Reader
    from kg.facts import Package

__all__ = ["read_cmake"]

_PLATFORM: Final = {
    **dict.fromkeys(("UNIX", "LINUX", "CMAKE_COMPILER_IS_GNUCXX"), "1"),
    **dict.fromkeys(("WIN32", "APPLE", "MSVC", "ANDROID", "CYGWIN", "MINGW", "IOS"), "0"),
    "CMAKE_SYSTEM_NAME": "Linux",
    "CMAKE_CXX_COMPILER_ID": "GNU",
    "CMAKE_SOURCE_DIR": SOURCE,
    "CMAKE_BINARY_DIR": BINARY,
    "PROJECT_BINARY_DIR": BINARY,
    "CMAKE_CURRENT_BINARY_DIR": BINARY,
    "CATKIN_DEVEL_PREFIX": BINARY,
    "EXECUTABLE_OUTPUT_PATH": BINARY,
}
_BUILD_DEPENDENCIES: Final = frozenset({"depend", "build_depend", "build_export_depend"})


def read_cmake(reader: Reader, folder: PackageFolder, package: Package) -> Collected:
    """Run the package's CMakeLists.txt, if it has one, and return what it declared."""
    model = Collected()
    files = CMakeFiles(reader, folder)
    names = [dependency.name for dependency in package.dependencies]
    files.packages.update(dict.fromkeys(names))
    run = Run(files, _scope(folder, package), HANDLERS | target_handlers(model))
    for path in _entrances(files, folder):
        run.run_file(path, own_folder=True)
    if run.stopped:
        reader.problem("KG122", "the file computes more than is followed", run.stopped.path, run.stopped.line)
    if run.too_deep:
        reader.problem("KG114", "blocks nested deeper are left out", run.too_deep.path, run.too_deep.line)
    return model


def _entrances(files: CMakeFiles, folder: PackageFolder) -> list[str]:
    """Return the CMakeLists.txt to run: the package's own; of loose code without one, the topmost of its folders."""
    path = folder.join("CMakeLists.txt")
    if files.exists(path) or folder.manifest:
        return [path] if files.exists(path) else []
    found = sorted(
        (e.path for e in folder.files if e.path.endswith("/CMakeLists.txt")), key=lambda path: path.count("/")
    )
    tops: list[str] = []
    for path in sorted(found, key=lambda path: path.count("/")):
        if not any(path.startswith(posixpath.dirname(top) + "/") for top in tops):
            tops.append(path)
    return tops


def _scope(folder: PackageFolder, package: Package) -> Scope:
    """Return the variables that are known before the first command."""
    top = SOURCE if folder.path == "." else posixpath.join(SOURCE, folder.path)
    needed = [d.name for d in package.dependencies if d.kind in _BUILD_DEPENDENCIES]
    variables = _PLATFORM | {
        "CMAKE_SOURCE_DIR": top,
        "PROJECT_SOURCE_DIR": top,
        "PROJECT_NAME": folder.name,
        "CATKIN_PACKAGE_BIN_DESTINATION": f"lib/{folder.name}",
        "CATKIN_PACKAGE_LIB_DESTINATION": "lib",
        "CATKIN_PACKAGE_SHARE_DESTINATION": f"share/{folder.name}",
        "CATKIN_GLOBAL_BIN_DESTINATION": "bin",
        "ROS_VERSION": str(package.ros),
        "ENV{ROS_VERSION}": str(package.ros),
        "catkin_FOUND": "1" if package.ros == 1 else "0",
        "ament_cmake_FOUND": "1" if package.ros == 2 else "0",  # noqa: PLR2004  (the version of ROS)
        "kg_build_dependencies": ";".join(needed),
    }
    return Scope(variables, set())
