"""Prints the processor seconds of extraction by stage, and the peak of memory, as JSON.

    python benchmarks/build/stages.py CHECKOUT [--whole] [--every N]

All packages are read in one process, as one worker of a build does; texts are left out, and nothing is wired, stored
or derived. A stage that calls another one is not charged for it. With `--whole` there is only the stage `rest`, since
the clock itself costs time. With `--every` only each n-th package is read, in the order of their paths. `parsing` is
the time to parse each file once, after all is read, `bytes` the size of the code of the packages that were read.
"""

from __future__ import annotations

import argparse
import gc
import json
import resource
import time
from pathlib import Path
from typing import TYPE_CHECKING

import tree_sitter_cpp
import tree_sitter_python
from clock import Clock, Stages
from tree_sitter import Language, Parser

from kg.corpus.reading import Reader
from kg.corpus.workspace import scan_tree
from kg.extract import cpp, definitions, implicit, manifests, parameters, python, texts
from kg.extract.cpp import syntax
from kg.extract.cpp.linking import Linker
from kg.extract.cpp.nodes import _Nodes
from kg.extract.cpp.units import CppUnit
from kg.extract.python import syntax as python_syntax
from kg.facts import FileKind
from kg.launch.files import reading as launch_files
from kg.pipeline import work
from kg.pipeline.recording import RecordingWorkspace

if TYPE_CHECKING:
    from collections.abc import Callable

    from kg.corpus.files import Source

STAGES: Stages = {
    "reading files": [(Reader, "read")],
    "parsing C++": [(syntax, "parse")],
    "lowering C++": [(CppUnit, "__init__"), (CppUnit, "lower_body"), (CppUnit, "expand")],
    "linking C++": [
        (Linker, name)
        for name, held in vars(Linker).items()
        if callable(held) and (name == "__init__" or not name.startswith("_"))
    ],
    "running C++": [(_Nodes, "_started"), (_Nodes, "executable")],
    "entries of C++": [(cpp, "read_nodes")],
    "parsing Python": [(python_syntax, "parse")],
    "Python": [(python, "read_nodes")],
    "launch files": [(launch_files, "read_launches")],
    "parameters": [(parameters, "attach"), (implicit, "add")],
    "definitions": [(definitions, "read_definitions")],
    "manifests": [(manifests, "read_manifest"), (manifests, "read_build")],
}
"""The functions that begin each stage."""
CODE: dict[FileKind, Callable[[], object]] = {
    FileKind.CPP: tree_sitter_cpp.language,
    FileKind.PYTHON: tree_sitter_python.language,
}
"""The kinds of files that are parsed, with their grammars."""


def main() -> None:
    """Read all packages of a checkout and print the figures."""
    options = _options()
    clock = Clock(STAGES)
    texts.read_descriptions = _no_texts
    if not options.whole:
        clock.attach()
    gc.set_threshold(500_000)  # as the workers of a build
    sources = scan_tree(options.checkout)
    workspace = RecordingWorkspace(sources)
    workspace.prepare()
    gc.freeze()
    clock.begin()
    whole = [(source, one) for source in sources for one in source.packages]
    packages = sorted(whole, key=lambda pair: pair[1].path)[:: options.every]
    for source, one in sorted(packages, key=lambda pair: -sum(entry.bytes for entry in pair[1].files)):
        workspace.forget()
        work.read_package(workspace, source, one)
    clock.enter("rest")
    size = sum(entry.bytes for _, one in packages for entry in one.files if entry.kind in CODE)
    peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1e3
    parsing = _parsing(list(sources)) if options.every == 1 else None
    print(json.dumps({"seconds": clock.seconds, "megabytes": peak, "parsing": parsing, "bytes": size}))


def _options() -> argparse.Namespace:
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("checkout", type=Path)
    parser.add_argument("--whole", action="store_true")
    parser.add_argument("--every", type=int, default=1)
    return parser.parse_args()


def _no_texts(*_: object, **__: object) -> tuple[()]:
    return ()


def _parsing(sources: list[Source]) -> float:
    """Return the processor seconds to parse each file of C++ and Python once."""
    parsers = {kind: Parser(Language(held())) for kind, held in CODE.items()}
    files = [
        (parsers[entry.kind], (source.root / entry.path).read_bytes())
        for source in sources
        for one in source.packages
        for entry in one.files
        if entry.kind in parsers
    ]
    began = time.process_time()
    for parser, content in files:
        parser.parse(content)
    return time.process_time() - began


if __name__ == "__main__":
    main()
