"""Allowed imports between packages, and the modules that a command may import at start."""

from __future__ import annotations

import json
import os
import subprocess
import sys

import pytest
from patience import patient
from repository import ROOT

HEAVY = {
    "asyncio",
    "lxml",
    "multiprocessing",
    "owlready2",
    "pyoxigraph",
    "pyshacl",
    "rdflib",
    "rich",
    "rosbags",
    "spacy",
    "tree_sitter",
    "tree_sitter_cpp",
    "tree_sitter_python",
    "yaml",
}

_IMPORTED = """
import json, sys
from kg.cli.main import run
sys.argv = ["kg", *sys.argv[1:]]
try:
    run()
except SystemExit:
    pass
print(json.dumps(sorted(sys.modules)), file=sys.stderr)
"""


def python(*arguments: str) -> subprocess.CompletedProcess[str]:
    """Run Python code in a process of its own, at the root of the repository."""
    environment = {**os.environ, "NO_COLOR": "1"}
    command = [sys.executable, *arguments]
    return subprocess.run(
        command, capture_output=True, text=True, check=True, cwd=ROOT, env=environment, timeout=patient(30)
    )


def imported(*arguments: str) -> set[str]:
    """Return the modules imported by a call of `kg`."""
    return set(json.loads(python("-c", _IMPORTED, *arguments).stderr.splitlines()[-1]))


def test_the_contracts_between_rooms_hold() -> None:
    """Every import contract of pyproject.toml holds."""
    pytest.importorskip("importlinter", reason="import-linter is not installed: pip install -e '.[dev]'")
    command = "from importlinter.cli import lint_imports; raise SystemExit(lint_imports(no_cache=True))"
    outcome = subprocess.run([sys.executable, "-c", command], capture_output=True, text=True, check=False, cwd=ROOT)
    assert outcome.returncode == 0, outcome.stdout


@pytest.mark.parametrize("arguments", [["--help"], ["--version"], ["build", "--help"], ["query", "--help"]])
def test_help_imports_nothing_heavy(arguments: list[str]) -> None:
    """Help and version import no parsers, stores or tables."""
    assert not HEAVY & imported(*arguments)


def test_the_package_itself_imports_nothing_heavy() -> None:
    """`import kg` alone loads no subpackage; a name of the public API loads only its own modules."""
    listing = "import json, sys, kg; print(json.dumps(sorted(sys.modules)))"
    loaded = set(json.loads(python("-c", listing).stdout))
    assert not HEAVY & loaded
    assert not [name for name in loaded if name.startswith("kg.")]


@pytest.mark.parametrize(
    "room", ["kg.extract", "kg.launch.files", "kg.launch.wiring", "kg.corpus", "kg.facts", "kg.names"]
)
def test_extraction_loads_no_rdf(room: str) -> None:
    """Source readers run without loading an RDF library."""
    listing = f"import json, sys, {room}; print(json.dumps(sorted(sys.modules)))"
    assert not {"pyoxigraph", "rdflib"} & set(json.loads(python("-c", listing).stdout))
