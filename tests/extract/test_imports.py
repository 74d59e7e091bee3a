"""Tests of imports in the sources of nodes."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

from extract.workspaces import manifest, written

from kg.corpus.reading import Reader
from kg.extract.imports import add_imports
from kg.facts import Location, NodeKind, NodeType

if TYPE_CHECKING:
    from pathlib import Path

NODE = NodeType("a", NodeKind.EXECUTABLE, "cpp", 1, Location("demo/src/a.cpp", 1))


def imports(root: Path, files: dict[str, str | bytes], begins: str, *sources: str) -> list[str]:
    """Return the imports of a node of the package `demo`, each name with its place."""
    workspace = written(root, {"demo/package.xml": manifest("demo"), **files})
    found = workspace.package("demo")
    assert found is not None
    node = replace(NODE, location=Location(begins, 1), sources=sources)
    source, package = workspace.folder(found)
    (complete,) = add_imports(Reader(workspace, source, package), package, (node,))
    return [f"{one.name} {one.location}" for one in complete.imports]


def test_headers_from_outside_count(tmp_path: Path) -> None:
    """A C++ include is an import with its line, except for the standard library."""
    text = '#include <vector>\n#include <serial/serial.h>\n// #include <no.h>\n#  include "linux/can.h"\n'
    assert imports(tmp_path, {"demo/src/a.cpp": text}, "demo/src/a.cpp") == [
        "linux/can.h demo/src/a.cpp:4",
        "serial/serial.h demo/src/a.cpp:2",
    ]


def test_own_headers_are_followed(tmp_path: Path) -> None:
    """A header of the package is not an import; its includes are."""
    files: dict[str, str | bytes] = {
        "demo/src/a.cpp": '#include "demo/port.h"\n',
        "demo/include/demo/port.h": '#include <libusb-1.0/libusb.h>\n#include "demo/port.h"\n',
    }
    assert imports(tmp_path, files, "demo/src/a.cpp") == ["libusb-1.0/libusb.h demo/include/demo/port.h:1"]


def test_modules_of_python_count(tmp_path: Path) -> None:
    """All forms of import are read, including several in one line."""
    text = "import os, serial as s\nfrom RPi.GPIO import (\n  output)\nif True:\n    import cv2  # pictures\n"
    assert imports(tmp_path, {"demo/scripts/a.py": text}, "demo/scripts/a.py") == [
        "RPi.GPIO demo/scripts/a.py:2",
        "cv2 demo/scripts/a.py:5",
        "os demo/scripts/a.py:1",
        "serial demo/scripts/a.py:1",
    ]


def test_own_modules_are_followed(tmp_path: Path) -> None:
    """Modules of the package are followed, by name, as part of a module and relative to the file."""
    files: dict[str, str | bytes] = {
        "demo/scripts/a.py": "from demo import port\nfrom demo.tools import one\n",
        "demo/src/demo/__init__.py": "",
        "demo/src/demo/port.py": "import smbus\n",
        "demo/src/demo/tools.py": "from .more import two\n",
        "demo/src/demo/more.py": "import usb.core\n",
    }
    assert imports(tmp_path, files, "demo/scripts/a.py") == [
        "smbus demo/src/demo/port.py:1",
        "usb.core demo/src/demo/more.py:1",
    ]


def test_files_of_other_nodes_do_not_count(tmp_path: Path) -> None:
    """Each node has the imports of its own sources."""
    files: dict[str, str | bytes] = {"demo/src/a.cpp": "#include <a.h>\n", "demo/src/b.cpp": "#include <b.h>\n"}
    assert imports(tmp_path, files, "demo/src/a.cpp", "demo/src/a.cpp") == ["a.h demo/src/a.cpp:1"]


def test_headers_of_other_packages_are_imports(tmp_path: Path) -> None:
    """A header found in another package is external; its includes are not followed."""
    files: dict[str, str | bytes] = {
        "lib/package.xml": manifest("lib"),
        "lib/include/lib/port.h": "#include <serial/serial.h>\n",
        "demo/src/a.cpp": "#include <lib/port.h>\n",
    }
    assert imports(tmp_path, files, "demo/src/a.cpp") == ["lib/port.h demo/src/a.cpp:1"]
