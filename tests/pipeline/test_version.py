"""Tests of the version that results depend on: contents of code and data, libraries, settings."""

from __future__ import annotations

import ast
import compileall
import json
import os
import shutil
import subprocess
import sys
from importlib.metadata import packages_distributions
from pathlib import Path
from typing import TYPE_CHECKING

import pytest

import kg
from kg import resources
from kg.pipeline.plan import CODE, LIBRARIES, version
from kg.settings import load

if TYPE_CHECKING:
    from collections.abc import Iterator

PACKAGE = Path(kg.__file__).resolve().parent
NOT_RESULTS = ("codes", "errors", "pipeline.report", "resources", "store")
"""Other modules loaded when reading a package: error texts, locations, writing of files."""
IMPORTS = """
import json, sys
import kg.pipeline.work, kg.launch.files.ros2.python.reading, kg.language.shipping, kg.language.lemmas
print(json.dumps([module.__file__ for name, module in sys.modules.items() if name.startswith("kg.")]))
"""


def code() -> Iterator[Path]:
    """Yield the modules in `CODE`."""
    for name in CODE:
        path = PACKAGE / name
        yield from path.rglob("*.py") if path.is_dir() else [path]


def test_a_fresh_installation_has_the_same_version(tmp_path: Path) -> None:
    """Bytecode and the times of files do not count."""
    shutil.copytree(PACKAGE / "extract", tmp_path / "extract", ignore=shutil.ignore_patterns("__pycache__"))
    before = resources.digest([tmp_path / "extract"])
    assert compileall.compile_dir(tmp_path / "extract" / "python", quiet=1)
    for path in tmp_path.rglob("*.py"):
        os.utime(path, (1, 1))
    assert resources.digest([tmp_path / "extract"]) == before == resources.digest([PACKAGE / "extract"])


@pytest.mark.parametrize("path", ["implicit.toml", "cmake-macros.cmake"])
def test_an_edit_of_data_of_the_same_size_and_time_is_another_version(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, path: str
) -> None:
    """Only the contents of data files count."""
    settings, copy = load({}, environment={}), tmp_path / "ontology"
    installed = version(settings)
    shutil.copytree(resources.folder("ontology"), copy)
    monkeypatch.setattr(resources, "folder", tmp_path.joinpath)
    assert version(settings) == installed
    edited = copy / path
    status, content = edited.stat(), edited.read_bytes()
    edited.write_bytes(content[:-2] + b"#\n")
    os.utime(edited, ns=(status.st_atime_ns, status.st_mtime_ns))
    assert version(settings) != installed


def test_names_of_files_count(tmp_path: Path) -> None:
    """A renamed file changes the digest; so does content moved to the next file."""
    (tmp_path / "a").mkdir()
    (tmp_path / "a" / "one.py").write_text("x")
    (tmp_path / "a" / "two.py").write_text("")
    before = resources.digest([tmp_path / "a"])
    (tmp_path / "a" / "two.py").rename(tmp_path / "a" / "three.py")
    renamed = resources.digest([tmp_path / "a"])
    (tmp_path / "a" / "one.py").rename(tmp_path / "a" / "two.py")
    assert len({before, renamed, resources.digest([tmp_path / "a"])}) == 3


def test_settings_that_results_depend_on_count() -> None:
    """The base of names, the size limit of files and the pipeline count; the number of workers does not."""
    chosen: list[dict[str, object]] = [{}, {"base": "https://x.org/"}, {"max_file_bytes": 7}, {"nlp_model": "other"}]
    assert len({version(load(options, environment={})) for options in chosen}) == len(chosen)
    assert version(load({"jobs": 7}, environment={})) == version(load({}, environment={}))


def test_all_code_that_reads_packages_counts() -> None:
    """The imports of a worker are part of the version."""
    run = subprocess.run([sys.executable, "-c", IMPORTS], capture_output=True, check=True)
    loaded = {Path(one) for one in json.loads(run.stdout)}
    exempt = {PACKAGE / "__init__.py", PACKAGE / "pipeline" / "__init__.py"}
    others = {".".join(one.relative_to(PACKAGE).with_suffix("").parts) for one in loaded - set(code()) - exempt}
    assert [one for one in sorted(others) if not one.startswith(NOT_RESULTS)] == []


def test_all_libraries_that_read_packages_count() -> None:
    """The distributions imported by this code are part of the version."""
    distributions = packages_distributions()
    imported: set[str] = set()
    for path in code():
        for statement in ast.walk(ast.parse(path.read_bytes())):
            names = [one.name for one in statement.names] if isinstance(statement, ast.Import) else []
            if isinstance(statement, ast.ImportFrom) and not statement.level:
                names = [statement.module or ""]
            imported.update(name.partition(".")[0] for name in names)
    outside = imported - sys.stdlib_module_names - {"kg", "pyshacl", "rdflib"}  # the last two check the ontologies
    assert {one.lower() for name in outside for one in distributions.get(name, ())} <= set(LIBRARIES)


def test_an_edit_of_an_ontology_is_the_same_version(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Only rules read ontologies, so packages need not be read again."""
    settings, copy = load({}, environment={}), tmp_path / "ontology"
    installed = version(settings)
    shutil.copytree(resources.folder("ontology"), copy)
    monkeypatch.setattr(resources, "folder", tmp_path.joinpath)
    (copy / "rnkg.ttl").write_text("")
    assert version(settings) == installed
