from __future__ import annotations

import subprocess
import sys
from typing import Final

HEAVY: Final = {
    "lxml",
    "owlready2",
    "pyoxigraph",
    "pyshacl",
    "rdflib",
    "rich",
    "rosbags",
    "spacy",
    "tree_sitter",
    "tree_sitter_cpp",
    "yaml",
    "importlib.metadata",
    "multiprocessing",
}
_PROGRAM: Final = "import sys; import kg.cli.app; print(*sorted(sys.modules))"


def test_the_command_line_loads_no_heavy_module() -> None:
    """`kg --help` stays under 150 ms because engines, parsers and rich load only in the commands that need them."""
    run = subprocess.run([sys.executable, "-c", _PROGRAM], capture_output=True, text=True, check=True)
    loaded = set(run.stdout.split())
    assert "kg.cli.app" in loaded
    assert loaded & HEAVY == set()
