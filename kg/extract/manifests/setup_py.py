"""setup.py, setup.cfg and pyproject.toml: entry points and scripts. Nothing in them is ever run."""

from __future__ import annotations

import configparser
import posixpath
import re
import tomllib
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Final

from kg.extract.buildmodel import EntryPoint, Script
from kg.facts import Location
from kg.lazily import lazily

if TYPE_CHECKING:
    from kg.corpus.files import PackageFolder
    from kg.corpus.reading import Reader
    from kg.extract.python.programs import Called

with lazily():
    from kg.extract.python.programs import calls_of, entries, lines

_SETUP_CALLS: Final = frozenset({"setup", "generate_distutils_setup"})
_ENTRY: Final = re.compile(r"^\s*([^\s=]+)\s*=\s*([\w.]+)\s*(?::\s*([\w.]+))?")


@dataclass(slots=True)
class Setup:
    """Declarations of the Python side of a package; parameter modules pair a module with its YAML file."""

    entry_points: dict[str, EntryPoint] = field(default_factory=dict)
    scripts: dict[str, Script] = field(default_factory=dict)
    parameter_modules: dict[tuple[str, str], None] = field(default_factory=dict)


def read_setup(reader: Reader, folder: PackageFolder) -> Setup:
    """Return the console scripts, scripts and parameter modules that a package declares."""
    collector = _Collector(reader, folder)
    for name, read in (("setup.py", _setup_py), ("setup.cfg", _setup_cfg), ("pyproject.toml", _pyproject)):
        path = folder.join(name)
        if reader.workspace.owner(reader.file(path)):
            text = reader.read(path)
            if text is not None:
                read(collector, path, text)
    return collector.setup


class _Collector:
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
        file = self.reader.workspace.module(module, near=self.reader.file(path))
        return file.path if file and file.repository == self.reader.repository else None


def _setup_py(collector: _Collector, path: str, text: bytes) -> None:
    written = text.decode().splitlines()
    for call in calls_of(collector.reader, collector.reader.file(path)):
        if call.name == "generate_parameter_module":
            match [lines(value) for value in call.values[:2]]:
                case [[module], [file]]:
                    collector.parameter_module(module, file)
        if call.name in _SETUP_CALLS:
            folders = entries(call.named.get("package_dir")).values()
            collector.roots[:0] = [folder for value in folders for folder in lines(value)]
            for line in _scripts_of(call):
                collector.entry(line, path, _line_of(written, line))
            for line in lines(call.named.get("scripts")):
                collector.script(line, path, _line_of(written, line))


def _scripts_of(call: Called) -> list[str]:
    """Return the console scripts of a call: those in a dictionary, or in a text that is written like an INI file."""
    given = call.named.get("entry_points")
    section, scripts = "", lines(entries(given).get("console_scripts"))
    for line in lines(given):
        if line.strip().startswith("["):
            section = line.strip(" []\t")
        elif section == "console_scripts":
            scripts.append(line)
    return scripts


def _setup_cfg(collector: _Collector, path: str, text: bytes) -> None:
    config = configparser.RawConfigParser(strict=False, allow_no_value=True)
    try:
        config.read_string(text.decode())
    except configparser.Error as error:
        collector.reader.problem("KG115", f"setup.cfg does not parse: {error.message.splitlines()[0]}", path)
        return
    lines = text.decode().splitlines()
    listed = config.get("options.entry_points", "console_scripts", fallback=None) or ""
    for written in listed.splitlines():
        collector.entry(written, path, _line_of(lines, written))
    for written in (config.get("options", "scripts", fallback=None) or "").splitlines():
        if written.strip():
            collector.script(written.strip(), path, _line_of(lines, written))


def _line_of(lines: list[str], written: str) -> int:
    """Return the first line that contains a text; of a text that the file computes, that with what is before `=`."""
    for text in (written.strip(), written.partition("=")[0].strip()):
        index = next((number for number, line in enumerate(lines, 1) if text and text in line), None)
        if index is not None:
            return index
    return 1


def _pyproject(collector: _Collector, path: str, text: bytes) -> None:
    try:
        project = tomllib.loads(text.decode()).get("project", {})
    except (tomllib.TOMLDecodeError, RecursionError) as error:
        collector.reader.problem("KG115", f"pyproject.toml does not parse: {error}", path)
        return
    scripts = project.get("scripts") if isinstance(project, dict) else None
    lines = text.decode().splitlines()
    for name, written in scripts.items() if isinstance(scripts, dict) else ():
        collector.entry(f"{name} = {written}", path, _line_of(lines, str(written)))
