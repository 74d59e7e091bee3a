"""Hostile or broken build files: each ends soon, is reported, and hides nothing else."""

from __future__ import annotations

import time
from typing import TYPE_CHECKING

import pytest
from extract.manifests.building import model_of
from extract.workspaces import reader_of

from kg.extract.manifests import read_manifest

if TYPE_CHECKING:
    from pathlib import Path

DOUBLING = 'set(x "${x}${x}ab;")\n'
HOSTILE = {
    "open brackets": "f(" + "[=[ " * 100_000,
    "open brackets of every length": "f(" + " ".join(f"[{'=' * n}[" for n in range(1500)),
    "open quotes": 'f(a"b ' * 100_000,
    "open comments": "#[[ " * 100_000,
    "nested parentheses": "f(" + "(" * 100_000,
    "nested blocks": "if(A)\nforeach(x a b)\n" * 20_000,
    "nested references": "set(x " + "${" * 50_000 + "}" * 50_000 + ")",
    "doubling": "set(x ab)\n" + DOUBLING * 500,
    "doubling in a loop": "foreach(i RANGE 2000)\nforeach(j RANGE 2000)\n" + DOUBLING + "endforeach()\nendforeach()\n",
    "patterns": "foreach(i RANGE 2000)\nfile(GLOB_RECURSE v *a*b*c*d*e*f*g*)\nendforeach()\n" * 50,
    "expressions": "foreach(i RANGE 2000)\nstring(REGEX REPLACE (.*)(.*)x z v aaaaaaaaaaaaaaaa)\nendforeach()\n" * 50,
    "open ifs over many variables": "".join(f"set(v{i} a)\n" for i in range(3000)) + "if(A)\nendif()\n" * 30_000,
    "recursion": "function(f)\nf(${ARGN} x)\nf(${ARGN} y)\nendfunction()\nf(a)\n",
    "inclusion": "include(CMakeLists.txt)\ninclude(CMakeLists.txt)\nadd_subdirectory(.)\nadd_subdirectory(sub)\n",
    "endless loop": "while(TRUE)\nset(x a)\nendwhile()\n" * 100,
    "no text": "\ufffd\x01\x02 ({[<>]})",
}  # fmt: skip


@pytest.mark.parametrize("kind", HOSTILE)
def test_hostile_cmake(tmp_path: Path, kind: str) -> None:
    """Reading any CMakeLists.txt takes at most seconds, and its first target is found."""
    text = "add_executable(first)\n" + HOSTILE[kind]
    reader = reader_of(tmp_path, {"CMakeLists.txt": text, "sub/CMakeLists.txt": "add_subdirectory(../)"})
    start = time.process_time()
    model = model_of(reader)
    assert time.process_time() - start < 8
    assert [target.name for target in model.targets] == ["first"]


@pytest.mark.parametrize(
    "content",
    [b"\0" * 100, b"\xff\xfe\xff", b"<" * 5000, b"(" * 5000, b"\x80\x81\x82", "é".encode("latin-1") * 100],
)
def test_every_file_may_be_broken(tmp_path: Path, content: bytes) -> None:
    """With any content of its build files, a package remains one, and broken files are reported."""
    names = ["package.xml", "CMakeLists.txt", "setup.py", "setup.cfg", "pyproject.toml", "plugins.xml"]
    reader = reader_of(tmp_path, dict.fromkeys(names, content))
    assert read_manifest(reader, reader.package).name == "demo"
    model = model_of(reader)
    assert (model.targets, model.plugins, model.entry_points) == ((), (), ())
    assert {problem.path.removeprefix("demo/") for problem in reader.problems} <= set(names)
    assert reader.problems
