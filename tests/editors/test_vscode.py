"""The VS Code extension: its own tests, which start the real server, and its package."""

from __future__ import annotations

import json
import os
import shutil
import subprocess
import sys
import zipfile
from typing import TYPE_CHECKING

import pytest
from repository import ROOT

if TYPE_CHECKING:
    from pathlib import Path

EXTENSION = ROOT / "editors" / "vscode"
pytestmark = pytest.mark.slow


def run(*command: str, **environment: str) -> str:
    """Run a command in the folder of the extension and return its output."""
    outcome = subprocess.run(
        command,
        cwd=EXTENSION,
        env={**os.environ, **environment},
        stdin=subprocess.DEVNULL,
        capture_output=True,
        text=True,
        check=False,
        timeout=600,
    )
    assert outcome.returncode == 0, f"{command}: {outcome.stdout}{outcome.stderr}"
    return outcome.stdout


@pytest.fixture(name="npm", scope="module")
def install() -> str:
    """Install the libraries of the lock file and return the program that installed them."""
    npm = shutil.which("npm")
    if npm is None:
        pytest.skip("Node.js with npm is not installed")
    run(npm, "ci")
    return npm


def test_the_extension(npm: str) -> None:
    """The tests of the extension pass with this `kg`."""
    pytest.importorskip("pygls", reason="the extra `lsp` is not installed")
    command = json.dumps([sys.executable, "-m", "kg"])
    assert "# fail 0" in run(npm, "test", KG_COMMAND=command, PYTHONPATH=str(ROOT))


def test_the_package(npm: str, tmp_path: Path) -> None:
    """The packaging tool of VS Code accepts the manifest; the package has the server's client, and no tests."""
    npx = str(npm).removesuffix("npm") + "npx"
    target = tmp_path / "kg.vsix"
    (EXTENSION / "LICENSE").write_bytes((ROOT / "LICENSE").read_bytes())
    tool = json.loads((EXTENSION / "package.json").read_text())["scripts"]["package"].partition("npx --yes ")[2].split()
    run(npx, "--yes", *tool, "--out", str(target))
    names = zipfile.ZipFile(target).namelist()
    assert "extension/extension.js" in names
    assert "extension/node_modules/vscode-languageclient/package.json" in names
    assert not [each for each in names if "/test/" in each and "node_modules" not in each]
