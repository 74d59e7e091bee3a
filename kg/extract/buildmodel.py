"""Build model of a package: which files make which executable, library, component or plugin.

`kg.extract.manifests` reads CMake, setup.py and plugin descriptions into a `BuildModel`; the readers of
C++ and Python take it as the answer to "which node does this code belong to".
"""

from __future__ import annotations

from dataclasses import dataclass
from enum import StrEnum
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from kg.facts import Location


class TargetKind(StrEnum):
    """What a build target becomes."""

    EXECUTABLE = "executable"
    LIBRARY = "library"
    TEST = "test"


@dataclass(frozen=True, slots=True)
class Target:
    """An executable or library of CMake.

    `sources` are paths relative to the root of the source, globs expanded; `links` are the names of targets
    (and packages) it links, as written after variables were expanded; `absent` are the macros that are defined for
    other targets alone, `values` those that are defined for this one, with what they stand for.
    """

    name: str
    kind: TargetKind
    sources: tuple[str, ...]
    links: tuple[str, ...]
    location: Location
    output_name: str | None = None
    absent: tuple[str, ...] = ()
    values: tuple[tuple[str, str], ...] = ()


class Registration(StrEnum):
    """How a class becomes loadable."""

    NODELET = "nodelet"
    COMPONENT = "component"
    PLUGIN = "plugin"


def last_part(name: str) -> str:
    """Return the last word of a plugin's name or class, with its template arguments."""
    stem, special, arguments = name.replace(" ", "").partition("<")
    return stem.rpartition("::")[2].rpartition("/")[2] + special + arguments


@dataclass(frozen=True, slots=True)
class PluginClass:
    """A class that is loaded by name: a nodelet, a component or another plugin.

    `name` is what a user loads (`package/Class` for pluginlib with a name, else the type), `type` the C++ class,
    `executable` the stand-alone executable that the build makes for it.
    """

    name: str
    type: str
    registration: Registration
    location: Location
    base_type: str | None = None
    library: str | None = None
    executable: str | None = None
    description: str | None = None


@dataclass(frozen=True, slots=True)
class Script:
    """A Python file that is installed or marked as a program; `name` as rosrun or ros2 run knows it."""

    name: str
    path: str
    location: Location


@dataclass(frozen=True, slots=True)
class EntryPoint:
    """A `console_scripts` entry point: `module` is dotted, `path` its file relative to the root of the source."""

    name: str
    module: str
    function: str
    path: str | None
    location: Location


@dataclass(frozen=True, slots=True)
class BuildModel:
    """The content of the build files of one package."""

    targets: tuple[Target, ...] = ()
    plugins: tuple[PluginClass, ...] = ()
    scripts: tuple[Script, ...] = ()
    entry_points: tuple[EntryPoint, ...] = ()
    programs: tuple[str, ...] = ()
    """Under which names CMake and Cargo install programs, those in no language that is read among them."""
    parameter_libraries: tuple[tuple[str, str], ...] = ()
    """Pairs of target name and YAML file of `generate_parameter_library`."""
    reconfigure_files: tuple[str, ...] = ()
    """The `.cfg` files of dynamic_reconfigure."""
    ros: int = 2
    """The version of ROS that the package is read for."""
    absent: tuple[str, ...] = ()
    """The macros that CMake defines for C++ only under conditions that do not hold."""
    defined: tuple[str, ...] = ()
    """The macros that CMake defines for C++, for all targets or for some."""
    values: tuple[tuple[str, str], ...] = ()
    """The macros that CMake defines for C++, with what they stand for in the code that is read."""
