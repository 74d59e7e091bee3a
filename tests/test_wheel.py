"""The shipped product works: the wheel, installed on its own, in an empty folder."""

from __future__ import annotations

import hashlib
import json
import os
import shutil
import subprocess
import sys
import venv
import zipfile
from typing import TYPE_CHECKING

import pytest
from repository import ROOT

if TYPE_CHECKING:
    from pathlib import Path

pytestmark = pytest.mark.slow

_OFFLINE = {"http_proxy": "http://127.0.0.1:9", "https_proxy": "http://127.0.0.1:9", "no_proxy": ""}


def run(*command: str | Path, folder: Path, **environment: str) -> str:
    """Run a command in a folder and return its output; a failure shows its standard error."""
    outcome = subprocess.run(
        [str(part) for part in command],
        cwd=folder,
        env={**os.environ, "NO_COLOR": "1", **environment},
        stdin=subprocess.DEVNULL,
        capture_output=True,
        text=True,
        check=False,
        timeout=900,
    )
    assert outcome.returncode == 0, f"{command}: {outcome.stdout}{outcome.stderr}"
    return outcome.stdout


@pytest.fixture(scope="module")
def wheel(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Build the wheel once, from the source distribution, as the package index would get it."""
    pytest.importorskip("build", reason="build is not installed: pip install -e '.[dev]'")
    dist = tmp_path_factory.mktemp("dist")
    run(sys.executable, "-m", "build", "--outdir", dist, ROOT, folder=dist)
    (built,) = dist.glob("*.whl")
    return built


@pytest.fixture(scope="module")
def installed(wheel: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Install the wheel into an environment of its own and return its folder of programs."""
    home = tmp_path_factory.mktemp("installed")
    venv.create(home, with_pip=True)
    run(home / "bin" / "pip", "install", "--quiet", "--disable-pip-version-check", wheel, folder=home)
    return home / "bin"


def test_the_wheel_carries_its_data(wheel: Path) -> None:
    """The wheel contains ontologies, queries, examples and the licence."""
    names = zipfile.ZipFile(wheel).namelist()
    for wanted in ("kg/_data/ontology/", "kg/_data/queries/", "kg/_data/examples/workspace/", "kg/py.typed"):
        assert any(name.startswith(wanted) for name in names), wanted
    assert any(name.endswith("licenses/LICENSE") for name in names)
    assert not [name for name in names if name.startswith(("tests/", "benchmarks/"))]


def test_the_wheel_carries_every_file_of_the_data(wheel: Path) -> None:
    """Every ontology, rule, query and example of the checkout is in the wheel."""
    names = set(zipfile.ZipFile(wheel).namelist())
    missing = [
        str(path.relative_to(ROOT))
        for folder in ("corpus", "ontology", "rules", "queries", "examples")
        for path in (ROOT / folder).rglob("*")
        if path.is_file() and f"kg/_data/{path.relative_to(ROOT)}" not in names and "__pycache__" not in path.parts
    ]
    assert not missing


def test_the_wheel_carries_the_tagger(wheel: Path) -> None:
    """Every file of the shipped pipeline is in the wheel, with the notice of the treebank's licence."""
    names = zipfile.ZipFile(wheel).namelist()
    model = [path for path in (ROOT / "kg" / "language" / "model").rglob("*") if path.is_file()]
    assert not {str(path.relative_to(ROOT)) for path in model} - set(names)
    assert any(name.endswith("licenses/kg/language/model/NOTICE") for name in names)


def test_the_wheel_carries_the_libraries_of_the_pages(wheel: Path) -> None:
    """Each library named by `frontend/package.json` is in the wheel, with the text of its licence."""
    if shutil.which("npm") is None:
        pytest.skip("Node.js with npm is not installed")
    archive = zipfile.ZipFile(wheel)
    manifest = json.loads(archive.read("kg/server/vendor/manifest.json"))
    wanted = json.loads((ROOT / "frontend" / "package.json").read_text("utf-8"))["dependencies"]
    shipped = {one["name"]: one for one in manifest["libraries"]}
    assert {name: shipped[name]["version"] for name in wanted} == wanted
    for name, one in shipped.items():
        content = archive.read(f"kg/server/vendor/{name}/{one['file']}")
        assert hashlib.sha256(content).hexdigest() == one["sha256"], name
        assert b"permission" in archive.read(f"kg/server/vendor/{name}/{one['notice']}").lower(), name
    assert not [name for name in archive.namelist() if "node_modules" in name]


def test_no_tool_of_development_is_needed(installed: Path) -> None:
    """The programs start with only the dependencies of the wheel."""
    assert run(installed / "kg", "--version", folder=installed).startswith("kg ")
    assert "demo" in run(installed / "kg", "--help", folder=installed)


def test_the_demo_runs_in_an_empty_folder(installed: Path, tmp_path: Path) -> None:
    """`kg demo` answers its questions in an empty folder and without the network."""
    answer = run(installed / "kg", "demo", folder=tmp_path, **_OFFLINE)
    assert "scan_filter_nodelet.cpp:30" in answer
    assert "flight_controller" in answer
