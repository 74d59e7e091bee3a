from __future__ import annotations

from typing import TYPE_CHECKING

import pytest
from extract.manifests.building import model_of
from extract.workspaces import manifest, reader_of, written

from kg.corpus.reading import Reader
from kg.extract.manifests.scripts import has_python_shebang

if TYPE_CHECKING:
    from pathlib import Path


def test_programs_of_a_package(tmp_path: Path) -> None:
    """Executable Python files with a shebang, and all with one in a folder for programs, are scripts."""
    shebang = "#!/usr/bin/env python3\n"
    files = {
        "demo/package.xml": manifest("demo"),
        "demo/scripts/marked.py": shebang,
        "demo/scripts/module.py": "import x\n",
        "demo/tools/run.py": shebang,
        "demo/tools/plain.py": shebang,
        "demo/launch/start.launch.py": shebang,
        "demo/cfg/Camera.cfg": shebang,
        "demo/src/talker": shebang,
    }
    written(tmp_path, files)
    for path in ("tools/run.py", "cfg/Camera.cfg", "src/talker", "launch/start.launch.py"):
        (tmp_path / "demo" / path).chmod(0o755)
    workspace = written(tmp_path, {})
    found = workspace.package("demo")
    assert found is not None
    scripts = model_of(Reader(workspace, *workspace.folder(found))).scripts
    expected = {"marked.py": "scripts/marked.py", "run.py": "tools/run.py", "talker": "src/talker"}
    assert {script.name: script.path for script in scripts} == {n: f"demo/{path}" for n, path in expected.items()}


def test_a_script_is_listed_once(tmp_path: Path) -> None:
    """A file that is installed, executable and named in setup.py is one script."""
    files = {
        "CMakeLists.txt": "catkin_install_python(PROGRAMS scripts/a.py DESTINATION lib/demo)",
        "setup.py": "setup(scripts=['scripts/a.py'])",
        "scripts/a.py": "#!/usr/bin/python\n",
    }
    assert [script.name for script in model_of(reader_of(tmp_path, files)).scripts] == ["a.py"]


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        (b"#!/usr/bin/env python3\n", True),
        (b"#!/usr/bin/python", True),
        (b"#! /usr/bin/env -S python3 -u\n", True),
        (b"#!/bin/sh\n# python\n", False),
        (b"import python\n", False),
        (b"", False),
        (None, False),
    ],
)
def test_shebangs(text: bytes | None, expected: bool) -> None:  # noqa: FBT001  (a case)
    """The first line determines the interpreter."""
    assert has_python_shebang(text) is expected


def test_programs_of_cargo(tmp_path: Path) -> None:
    """A crate installs the programs that it lists, and one of its own name; a broken Cargo.toml names none."""
    crate = '[package]\nname = "ebox"\n[[bin]]\nname = "lights"\npath = "src/lights.rs"\n[lib]\nname = "shared"\n'
    assert model_of(reader_of(tmp_path / "a", {"Cargo.toml": crate})).programs == ("lights", "ebox")
    assert model_of(reader_of(tmp_path / "b", {"Cargo.toml": "[package\n"})).programs == ()
