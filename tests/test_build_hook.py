"""The build hook says what a package lacks, and makes no release without it."""

from __future__ import annotations

import os
import shutil
import sys
from types import ModuleType, SimpleNamespace
from typing import TYPE_CHECKING, Any

import pytest
from repository import ROOT

if TYPE_CHECKING:
    from pathlib import Path


class _AbortedError(Exception):
    pass


class _App:
    """What hatchling gives a hook to speak through."""

    def __init__(self) -> None:
        self.warnings: list[str] = []

    def display_warning(self, words: str) -> None:
        """Keep a warning."""
        self.warnings.append(words)

    def abort(self, words: str) -> None:
        """End the build."""
        raise _AbortedError(words)


@pytest.fixture
def hook(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Any:
    """The hook for a checkout without libraries, on a machine without Node.js."""
    names = ["hatchling", "hatchling.builders", "hatchling.builders.hooks", "hatchling.builders.hooks.plugin"]
    for name in names:
        monkeypatch.setitem(sys.modules, name, ModuleType(name))
    interface = ModuleType(f"{names[-1]}.interface")
    interface.BuildHookInterface = dict  # type: ignore[attr-defined]  # any class with a parameter
    monkeypatch.setitem(sys.modules, interface.__name__, interface)
    monkeypatch.setenv("PATH", "/nowhere")
    monkeypatch.delenv("KG_REQUIRE_LIBRARIES", raising=False)
    shutil.copytree(ROOT / "frontend", tmp_path / "frontend", ignore=shutil.ignore_patterns("node_modules"))
    namespace: dict[str, Any] = {"__name__": "hatch_build"}
    exec((ROOT / "hatch_build.py").read_text("utf-8"), namespace)  # noqa: S102 - no package has it
    made = namespace["PackageHook"]()
    made.root, made.app = str(tmp_path), _App()
    return made


def test_a_wheel_without_libraries_is_made_with_a_warning(hook: Any) -> None:
    """Who has no Node.js gets an installation, and is told what it lacks."""
    hook.target_name = "wheel"
    hook.initialize("standard", {})
    assert "no pictures" in hook.app.warnings[0]
    assert "Node.js with npm is not installed" in hook.app.warnings[0]


@pytest.mark.parametrize(("target", "required"), [("sdist", ""), ("wheel", "1")])
def test_a_release_without_libraries_is_not_made(
    hook: Any, target: str, required: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A source distribution, of which releases are made, and a wheel where that is wanted, fail with the way out."""
    hook.target_name = target
    monkeypatch.setenv("KG_REQUIRE_LIBRARIES", required)
    with pytest.raises(_AbortedError, match="Install Node"):
        hook.initialize("standard", {})


def test_a_package_with_its_libraries_is_made_in_silence(hook: Any, tmp_path: Path) -> None:
    """Where the libraries of the lock file are there, nothing is built and nothing said."""
    vendor = tmp_path / "kg" / "server" / "vendor"
    vendor.mkdir(parents=True)
    build = SimpleNamespace(**_loaded(tmp_path / "frontend" / "build.py"))
    (vendor / "manifest.json").write_text(f'{{"lock": "{build._digest(build.LOCK)}", "libraries": []}}')
    hook.target_name = "sdist"
    hook.initialize("standard", {})
    assert hook.app.warnings == []


def _loaded(path: Path) -> dict[str, Any]:
    namespace: dict[str, Any] = {"__name__": "frontend_build", "__file__": str(path)}
    exec(path.read_text("utf-8"), namespace)  # noqa: S102 - a script of the checkout
    return namespace


_COMPILER = """
REQUIRED = ("a compiler",)
class CompileError(Exception): ...
def build(root, folder):
    made = folder / "machine.so"
    made.touch()
    if (root / "broken").exists():
        raise CompileError("line 7 is wrong")
    return {made: "kg/symbolic/machine.so"}
"""


@pytest.fixture
def wheel(hook: Any, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Any:
    """The hook for a wheel, with a compiler that takes no time."""
    (tmp_path / "hatch_compile.py").write_text(_COMPILER)
    monkeypatch.delenv("KG_COMPILE", raising=False)
    hook.target_name = "wheel"
    return hook


def test_a_wheel_is_pure_unless_it_is_to_be_compiled(wheel: Any) -> None:
    """Nothing is compiled, and nothing needed for it, where nobody asks for it."""
    data: dict[str, Any] = {"force_include": {}}
    wheel.initialize("standard", data)
    assert data == {"force_include": {}}
    assert wheel.dependencies() == []


def test_a_compiled_wheel_is_of_one_platform(wheel: Any, monkeypatch: pytest.MonkeyPatch) -> None:
    """With KG_COMPILE the libraries are in the wheel, and its name says for what machine it is."""
    monkeypatch.setenv("KG_COMPILE", "1")
    data: dict[str, Any] = {"force_include": {}}
    wheel.initialize("standard", data)
    (library,) = data["force_include"]
    assert data == {"force_include": {library: "kg/symbolic/machine.so"}, "pure_python": False, "infer_tag": True}
    assert wheel.dependencies() == ["a compiler"]
    wheel.finalize("standard", data, "")
    assert not os.path.exists(library)  # noqa: PTH110 - hatchling takes texts


def test_an_editable_installation_is_not_compiled(wheel: Any, monkeypatch: pytest.MonkeyPatch) -> None:
    """Who changes the code sees the change."""
    monkeypatch.setenv("KG_COMPILE", "1")
    data: dict[str, Any] = {"force_include": {}}
    wheel.initialize("editable", data)
    assert data == {"force_include": {}}


def test_what_cannot_be_compiled_is_said(wheel: Any, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A compilation that was asked for and fails ends the build, with the words of the compiler and the way out."""
    monkeypatch.setenv("KG_COMPILE", "1")
    (tmp_path / "broken").touch()
    with pytest.raises(_AbortedError, match="line 7 is wrong\nInstall a C compiler, or build without KG_COMPILE"):
        wheel.initialize("standard", {"force_include": {}})
