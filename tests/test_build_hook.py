"""The build hook reports missing parts of a package, and makes no release without them."""

from __future__ import annotations

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
    """The interface that hatchling gives to a hook for messages."""

    def __init__(self) -> None:
        self.warnings: list[str] = []

    def display_warning(self, words: str) -> None:
        """Store a warning."""
        self.warnings.append(words)

    def abort(self, words: str) -> None:
        """Abort the build."""
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
    made = namespace["LibrariesHook"]()
    made.root, made.app = str(tmp_path), _App()
    return made


def test_a_wheel_without_libraries_is_made_with_a_warning(hook: Any) -> None:
    """Without Node.js, the installation succeeds and a warning lists the missing parts."""
    hook.target_name = "wheel"
    hook.initialize("standard", {})
    assert "no pictures" in hook.app.warnings[0]
    assert "Node.js with npm is not installed" in hook.app.warnings[0]


@pytest.mark.parametrize(("target", "required"), [("sdist", ""), ("wheel", "1")])
def test_a_release_without_libraries_is_not_made(
    hook: Any, target: str, required: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A source distribution, and a wheel that requires the libraries, fail with instructions."""
    hook.target_name = target
    monkeypatch.setenv("KG_REQUIRE_LIBRARIES", required)
    with pytest.raises(_AbortedError, match="Install Node"):
        hook.initialize("standard", {})


def test_a_package_with_its_libraries_is_made_in_silence(hook: Any, tmp_path: Path) -> None:
    """With the libraries of the lock file present, nothing is built or printed."""
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
