"""Workspaces of repositories at their commits, with a launch file that starts a whole system."""

from __future__ import annotations

import re
import shutil
import subprocess
from dataclasses import dataclass, field
from pathlib import Path, PurePosixPath
from typing import TYPE_CHECKING
from xml.sax.saxutils import quoteattr

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping

LARGEST = 1_000_000
"""Files of more bytes (meshes, bags, maps) are left out: no source is as large."""
SYSTEM = "bug_system"
"""The package that the runner writes."""
LINK = b"120000"
PROGRAM = b"100755"


class MissingError(Exception):
    """A repository or a commit that the mirrors do not have."""


@dataclass(frozen=True)
class Beside:
    """A node that the runner writes: it `publishes` or `subscribes` a name with a type."""

    role: str
    name: str
    type: str


@dataclass
class Plan:
    """What a workspace consists of: (repository, folder, commit), (launch file, arguments), nodes, counterparts."""

    trees: list[tuple[str, str, str]]
    starts: list[tuple[str, Mapping[str, str]]]
    nodes: Iterable[tuple[str, str]] = ()
    beside: Iterable[Beside] = field(default_factory=list)


def git_folder(mirrors: Path, repository: str) -> Path:
    """Return the git directory of `owner/name` below `mirrors`, however it is laid out there."""
    flat = repository.replace("/", "+")
    for name in (
        f"{flat}/repo/.git",
        f"{flat}/repo",
        f"{flat}/.git",
        f"{flat}.git",
        flat,
        repository,
        f"{repository}.git",
    ):
        folder = mirrors / name
        if (folder / "HEAD").is_file() and (folder / "objects").is_dir():
            return folder
        if (folder / ".git" / "HEAD").is_file():
            return folder / ".git"
    raise MissingError(f"{mirrors} has no git directory of {repository}")


def unpack(git: Path, commit: str, target: Path) -> None:
    """Write the tree of a commit; large files, and files that the mirror lacks, are left out.

    Links within the tree stay links; others are left out.
    """
    listing = _git(git, ["ls-tree", "-r", "-z", commit])
    entries = [
        (meta.split(), path) for meta, _, path in (entry.partition(b"\t") for entry in listing.split(b"\0")) if path
    ]
    blobs = {path: meta[2] for meta, path in entries if meta[1] == b"blob"}
    programs = {path for meta, path in entries if meta[0] == PROGRAM}
    links = {path for meta, path in entries if meta[0] == LINK}
    small = _small(git, set(blobs.values()))
    contents = _contents(git, small)
    for path, blob in blobs.items():
        if blob in contents and path in links:
            _link(target, path.decode("utf-8", "replace"), contents[blob].decode("utf-8", "replace"))
        elif blob in contents:
            _write(target, path.decode("utf-8", "replace"), contents[blob], program=path in programs)


def _link(target: Path, name: str, leads_to: str) -> None:
    path = target / name
    if (path.parent / leads_to).resolve().is_relative_to(target.resolve()):
        path.parent.mkdir(parents=True, exist_ok=True)
        path.symlink_to(leads_to)


def make(plan: Plan, mirrors: Path, target: Path) -> Path:
    """Write the workspace into `target`, which is emptied before, and return the launch file of the system."""
    shutil.rmtree(target, ignore_errors=True)
    for repository, folder, commit in plan.trees:
        unpack(git_folder(mirrors, repository), commit, target / folder)
    package = target / SYSTEM
    beside = list(plan.beside)
    _write(package, "package.xml", _MANIFEST.encode())
    _write(package, "CMakeLists.txt", (_BUILD + (_INSTALL if beside else "")).encode())
    _write(package, "launch/empty.launch", b"<launch/>\n")
    if beside:
        _write(package, "scripts/counterpart.py", _counterpart(beside).encode())
    launch = package / "launch" / "system.launch"
    launch.write_text(_launch(plan, counterpart=bool(beside)))
    return launch


def environment(values: Mapping[str, str]) -> dict[str, str]:
    """Replace `{package:NAME}` in values by what `kg` writes for the folder of a package."""
    return {key: re.sub(r"\{package:([^}]+)\}", r"package://\1", value) for key, value in values.items()}


def _git(git: Path, arguments: list[str], given: bytes | None = None) -> bytes:
    command = ["git", "--git-dir", str(git), "-c", "core.hooksPath=/dev/null", *arguments]
    done = subprocess.run(command, input=given, capture_output=True, check=False)
    if done.returncode:
        raise MissingError(f"{git}: {done.stderr.decode(errors='replace').strip()}")
    return done.stdout


def _small(git: Path, blobs: set[bytes]) -> list[bytes]:
    checked = _git(git, ["cat-file", "--batch-check"], b"\n".join(blobs) + b"\n")
    rows = (line.split() for line in checked.splitlines())
    return [row[0] for row in rows if row[-1] != b"missing" and int(row[2]) <= LARGEST]


def _contents(git: Path, blobs: list[bytes]) -> dict[bytes, bytes]:
    text = _git(git, ["cat-file", "--batch"], b"\n".join(blobs) + b"\n") if blobs else b""
    found, at = {}, 0
    while at < len(text):
        end = text.index(b"\n", at)
        blob, _, size = text[at:end].split()
        found[blob] = text[end + 1 : end + 1 + int(size)]
        at = end + 2 + int(size)
    return found


def _write(folder: Path, path: str, content: bytes, *, program: bool = False) -> None:
    pure = PurePosixPath(path)
    if pure.is_absolute() or ".." in pure.parts:
        raise MissingError(f"{path} leads out of its tree")
    target = folder / pure
    target.parent.mkdir(parents=True, exist_ok=True)
    target.write_bytes(content)
    if program:
        target.chmod(0o755)


def _launch(plan: Plan, *, counterpart: bool) -> str:
    lines = ["<launch>"]
    if counterpart:
        lines.append(f'  <node pkg="{SYSTEM}" type="counterpart.py" name="counterpart"/>')
    for file, arguments in plan.starts:
        package, _, path = file.partition("/")
        lines.append(f"  <include file={quoteattr(f'$(find {package})/{path}')}>")
        lines += [f"    <arg name={quoteattr(name)} value={quoteattr(value)}/>" for name, value in arguments.items()]
        lines.append("  </include>")
    for package, kind in plan.nodes:
        name = kind.removesuffix(".py")
        lines.append(f"  <node pkg={quoteattr(package)} type={quoteattr(kind)} name={quoteattr(name)}/>")
    return "\n".join([*lines, "</launch>"]) + "\n"


def _counterpart(beside: list[Beside]) -> str:
    lines = ["#!/usr/bin/env python", "import rospy"]
    lines += sorted({f"from {one.type.split('/')[0]}.msg import {one.type.split('/')[1]}" for one in beside})
    lines += ["", 'rospy.init_node("counterpart")']
    for one in beside:
        kind = one.type.split("/")[1]
        if one.role == "publishes":
            lines.append(f'rospy.Publisher("{one.name}", {kind}, queue_size=1)')
        else:
            lines.append(f'rospy.Subscriber("{one.name}", {kind}, print)')
    return "\n".join([*lines, "rospy.spin()"]) + "\n"


_MANIFEST = f"""<package format="2">
  <name>{SYSTEM}</name>
  <version>0.0.0</version>
  <description>Starts the parts of a system together.</description>
  <maintainer email="nobody@example.org">nobody</maintainer>
  <license>Apache-2.0</license>
  <buildtool_depend>catkin</buildtool_depend>
</package>
"""
_BUILD = f"""cmake_minimum_required(VERSION 2.8.3)
project({SYSTEM})
find_package(catkin REQUIRED)
catkin_package()
"""
_INSTALL = "catkin_install_python(PROGRAMS scripts/counterpart.py DESTINATION ${CATKIN_PACKAGE_BIN_DESTINATION})\n"
