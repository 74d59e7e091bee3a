from __future__ import annotations

from typing import TYPE_CHECKING

import pytest
from extract.manifests.building import model_of
from extract.workspaces import codes, reader_of

if TYPE_CHECKING:
    from pathlib import Path

TALKER = "demo/demo/talker.py"


def entries(root: Path, setup: str, **more: str) -> dict[str, tuple[str, str, str | None, int]]:
    """Return module, function, path and line of each entry point of a setup.py that imports `setup`."""
    reader = reader_of(root, {"setup.py": f"from setuptools import setup\n{setup}", "demo/talker.py": "", **more})
    found = model_of(reader).entry_points
    return {point.name: (point.module, point.function, point.path, point.location.line) for point in found}


@pytest.mark.parametrize(
    "setup",
    [
        "setup(entry_points={'console_scripts': ['talker = demo.talker:main']})",
        "import setuptools\nsetuptools.setup(name='x', entry_points={'console_scripts': ['talker=demo.talker:main']})",
        "p = 'demo'\nsetup(entry_points={'console_scripts': ['talker = ' + p + '.talker:main']})",
        "p = 'demo'\nsetup(entry_points={'console_scripts': [f'talker = {p}.talker:main']})",
        "p = 'demo'\nsetup(entry_points={'console_scripts': ['talker = {}.talker:main'.format(p)]})",
        "p = 'demo'\nsetup(entry_points={'console_scripts': ['talker = %s.talker:main' % p]})",
        "setup(entry_points={'console_scripts': [f'{n} = demo.{n}:main' for n in ['talker']]})",
        "e = {'console_scripts': ['talker = demo.talker:main']}\nsetup(entry_points=e)",
        "setup(entry_points='''\n[console_scripts]\ntalker = demo.talker:main\n[other]\nx = y:z\n''')",
        "setup(entry_points={'console_scripts': 'talker = demo.talker:main'})",
        "kw = dict(entry_points={'console_scripts': ['talker = demo.talker:main']})\nsetup(**kw)",
        "if __name__ == '__main__':\n    setup(entry_points={'console_scripts': ('talker = demo.talker:main',) + ()})",
        "setup(entry_points={'console_scripts': [*['talker = demo.talker:main'], make()]})",
    ],
)
def test_entry_points(tmp_path: Path, setup: str) -> None:
    """Console scripts are found in every usual spelling, without running code."""
    found = entries(tmp_path, setup)
    assert {name: values[:3] for name, values in found.items()} == {"talker": ("demo.talker", "main", TALKER)}


def test_lines(tmp_path: Path) -> None:
    """An entry point has the line of its own text."""
    setup = """setup(
  entry_points={
    'console_scripts': [
      'a = demo.talker:main',
      'b = gone:main',
    ]})"""
    found = entries(tmp_path, setup)
    assert found == {"a": ("demo.talker", "main", TALKER, 5), "b": ("gone", "main", None, 6)}


def test_package_dir(tmp_path: Path) -> None:
    """Modules are searched below the folder named by package_dir."""
    setup = "setup(package_dir={'': 'lib'}, entry_points={'console_scripts': ['x = other.node:run']})"
    found = entries(tmp_path, setup, **{"lib/other/node.py": ""})
    assert found["x"][2] == "demo/lib/other/node.py"


def test_scripts_of_catkin(tmp_path: Path) -> None:
    """generate_distutils_setup and scripts= declare existing scripts."""
    setup = """from catkin_pkg.python_setup import generate_distutils_setup
d = generate_distutils_setup(packages=['demo'], package_dir={'': 'src'}, scripts=['bin/run', 'bin/gone'])
setup(**d)
"""
    reader = reader_of(tmp_path, {"setup.py": setup, "bin/run": "#!/usr/bin/env python\n"})
    found = model_of(reader).scripts
    assert [(script.name, script.path, script.location.line) for script in found] == [("run", "demo/bin/run", 2)]


def test_parameter_modules(tmp_path: Path) -> None:
    """YAML files from which setup.py generates parameter modules are recorded."""
    setup = """from generate_parameter_library_py.setup_helper import generate_parameter_module
generate_parameter_module("talker_parameters", "demo/talker.yaml", validation_module="x")
generate_parameter_module("gone", "demo/gone.yaml")
generate_parameter_module(1)
"""
    model = model_of(reader_of(tmp_path, {"setup.py": setup, "demo/talker.yaml": ""}))
    assert model.parameter_libraries == (("talker_parameters", "demo/demo/talker.yaml"),)


def test_setup_cfg(tmp_path: Path) -> None:
    """setup.cfg may contain the same."""
    cfg = """[options]
scripts =
  demo/talker.py
[options.entry_points]
console_scripts =
  talker = demo.talker:main
"""
    reader = reader_of(tmp_path, {"setup.cfg": cfg, "demo/talker.py": "#!/usr/bin/env python3\n"})
    model = model_of(reader)
    assert [(point.name, point.path, point.location.line) for point in model.entry_points] == [("talker", TALKER, 6)]
    assert [script.path for script in model.scripts] == [TALKER]


def test_pyproject(tmp_path: Path) -> None:
    """[project.scripts] of pyproject.toml counts, too."""
    text = '[project]\nname = "demo"\n[project.scripts]\ntalker = "demo.talker:main"\n'
    reader = reader_of(tmp_path, {"pyproject.toml": text, "demo/talker.py": ""})
    (point,) = model_of(reader).entry_points
    assert (point.name, point.module, point.location.line) == ("talker", "demo.talker", 4)


@pytest.mark.parametrize(
    ("name", "text", "line"),
    [
        ("setup.py", "setup(\n  entry_points={'console_scripts': [)\n", 2),
        ("setup.cfg", "no section\n", None),
        ("pyproject.toml", "[project\n", None),
        ("pyproject.toml", "x = " + "[" * 5000, None),
    ],
)
def test_malformed(tmp_path: Path, name: str, text: str, line: int | None) -> None:
    """A syntax error is reported, and the rest is read."""
    reader = reader_of(tmp_path, {name: text})
    assert model_of(reader).entry_points == ()
    assert [code for code, _ in codes(reader.problems)] == ["KG115"]
    assert line is None or codes(reader.problems)[0][1] == line


@pytest.mark.parametrize(
    "setup",
    [
        "open('/tmp/kg-was-here', 'w')\nsetup()",
        "setup(entry_points={'console_scripts': " + "[" * 5000 + "]" * 5000 + "})",
        "setup(entry_points={'console_scripts': [" + "'a' + " * 5000 + "'b']})",
        "x = x + x\nsetup(entry_points=x, scripts=x, package_dir=x)",
        "setup(entry_points={1: 2}, scripts=3)\nsetup(*a, **b)",
        "#!/usr/bin/env python\nprint 'python 2'\nsetup()",
    ],
)
def test_hostile(tmp_path: Path, setup: str) -> None:
    """Deeply nested, odd or expensive files are read to their end and never run."""
    assert entries(tmp_path, setup) == {}
    assert not (tmp_path.parent / "kg-was-here").exists()
