"""The container image: small, built from the repository alone, run without root."""

from __future__ import annotations

import re
import shutil
import subprocess
import sys
from pathlib import Path
from typing import Final

import pytest
from repository import ROOT, files

DOCKERFILE: Final = ROOT / "Dockerfile"
IGNORED: Final = ROOT / ".dockerignore"


def instructions() -> list[tuple[str, str]]:
    """Return the instructions of the Dockerfile as (name, arguments), continued lines joined."""
    lines = [line for line in DOCKERFILE.read_text("utf-8").splitlines() if not line.startswith("#")]
    joined = re.sub(r"\\\n", " ", "\n".join(lines))
    return [(name, rest.strip()) for name, _, rest in (line.partition(" ") for line in joined.splitlines() if line)]


def stages() -> list[list[tuple[str, str]]]:
    """Return the instructions of each stage, which begins with its FROM."""
    found: list[list[tuple[str, str]]] = []
    for one in instructions():
        if one[0] == "FROM":
            found.append([])
        found[-1].append(one)
    return found


def matcher(pattern: str) -> re.Pattern[str]:
    """Return the regular expression of a pattern of .dockerignore, which also matches everything below a folder."""
    everywhere = pattern.startswith("**/")
    name = re.escape(pattern.removeprefix("**/")).replace(r"\*", "[^/]*")
    return re.compile(f"{'(?:.*/)?' if everywhere else ''}{name}(?:/.*)?")


def sent() -> set[str]:
    """Return the files that `docker build .` sends by the patterns of .dockerignore; the last match wins."""
    lines = [line for line in IGNORED.read_text("utf-8").splitlines() if line and not line.startswith("#")]
    patterns = [(matcher(line.removeprefix("!")), line.startswith("!")) for line in lines]
    names = [path.relative_to(ROOT).as_posix() for path in files()]
    last = {name: [kept for pattern, kept in patterns if pattern.fullmatch(name)] for name in names}
    return {name for name, matched in last.items() if not matched or matched[-1]}


def test_images_are_pinned_to_a_version() -> None:
    """Every stage starts from the same tag, which names a version of Python."""
    bases = {stage[0][1].split()[0] for stage in stages()}
    assert len(bases) == 1
    assert re.fullmatch(r"python:3\.\d+-slim-\w+", bases.pop())


def test_the_image_runs_without_root() -> None:
    """The last stage switches to a numbered user other than root, after every step that needs root."""
    names = [name for name, _ in stages()[-1]]
    user = dict(stages()[-1])["USER"]
    assert user.isdecimal()
    assert int(user) > 0
    assert not {"RUN", "COPY", "ADD"} & set(names[names.index("USER") :])


def test_layers_keep_no_caches() -> None:
    """Installs disable the cache of pip, and remove package lists in the layer that fetched them."""
    for name, arguments in instructions():
        if name == "RUN" and "pip install" in arguments:
            assert "--no-cache-dir" in arguments
        if name == "RUN" and "apt-get update" in arguments:
            assert "--no-install-recommends" in arguments
            assert "rm -rf /var/lib/apt/lists/*" in arguments


def test_sources_stay_in_the_first_stage() -> None:
    """The image contains the installed environment, without the sources and the build tools."""
    copied = [arguments for name, arguments in stages()[-1] if name in {"COPY", "ADD"}]
    assert copied == ["--from=build /opt/kg /opt/kg"]


def test_the_context_has_what_the_package_is_built_from() -> None:
    """.dockerignore admits every file that hatch puts into a wheel, and no tests or stores."""
    names = sent()
    wanted = {"pyproject.toml", "hatch_build.py", "README.md", "LICENSE", "docs/kg.1", "frontend/package-lock.json"}
    for path in files():
        name = path.relative_to(ROOT).as_posix()
        if name.startswith(("kg/", "corpus/", "ontology/", "queries/", "rules/", "examples/")):
            wanted.add(name)
    assert not wanted - names
    assert not [name for name in names if name.startswith(("tests/", "benchmarks/", ".git/"))]


def test_hadolint_finds_nothing() -> None:
    """Hadolint accepts the Dockerfile."""
    program = shutil.which("hadolint", path=str(Path(sys.executable).parent)) or shutil.which("hadolint")
    if program is None:
        pytest.skip("hadolint is not installed: pip install -e '.[dev]'")
    ran = subprocess.run([program, "--no-color", DOCKERFILE], capture_output=True, text=True, check=False)
    assert ran.returncode == 0, ran.stdout
