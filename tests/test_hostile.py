"""Broken or hostile sources: each is reported, the others are built, and none of their code is executed."""

from __future__ import annotations

import json
import os
import re
from typing import TYPE_CHECKING, Any, Final

import pytest
from cli.program import Program, Run

if TYPE_CHECKING:
    from collections.abc import Callable
    from pathlib import Path

_MANIFEST: Final = """<?xml version="1.0"?>
<package format="2">
  <name>{name}</name><version>1.0.0</version><description>A package.</description>
  <maintainer email="a@example.org">A</maintainer><license>Apache-2.0</license>
</package>
"""
_NODE: Final = """
#include <ros/ros.h>
#include <std_msgs/String.h>
int main(int argc, char** argv) {
  ros::init(argc, argv, "talker");
  ros::NodeHandle nh;
  ros::Publisher pub = nh.advertise<std_msgs::String>("chatter", 1);
  ros::spin();
}
"""
_DEEP: Final = 5_000
_HUGE_BYTES: Final = 5 << 20


def healthy(folder: Path, name: str = "healthy") -> Path:
    """Write a package with one node that publishes `chatter`."""
    (folder / "src").mkdir(parents=True)
    (folder / "package.xml").write_text(_MANIFEST.format(name=name))
    (folder / "CMakeLists.txt").write_text(f"project({name})\nadd_executable(talker src/talker.cpp)\n")
    (folder / "src" / "talker.cpp").write_text(_NODE)
    return folder


def write(path: Path, data: str | bytes) -> None:
    """Write a file and the folders above it."""
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_bytes(data.encode() if isinstance(data, str) else data)


def unreadable(package: Path) -> None:
    """Remove the permission to read a file."""
    write(package / "src" / "secret.cpp", _NODE)
    (package / "src" / "secret.cpp").chmod(0)


def broken_link(package: Path) -> None:
    """Create a dangling link in place of a source file."""
    (package / "src" / "gone.cpp").symlink_to(package / "nowhere.cpp")


def link_loop(package: Path) -> None:
    """Create links in a loop, of files and of folders."""
    (package / "src" / "loop.cpp").symlink_to(package / "src" / "loop.cpp")
    (package / "src" / "again").symlink_to(package, target_is_directory=True)


BROKEN: Final[dict[str, tuple[str, Callable[[Path], None]]]] = {
    "binary": ("blob.cpp", lambda package: write(package / "src" / "blob.cpp", b"\x7fELF\0\0\0" * 100)),
    "huge": ("huge.cpp", lambda package: write(package / "src" / "huge.cpp", b"int x;\n" * (_HUGE_BYTES // 7))),
    "encoding": ("latin.cpp", lambda package: write(package / "src" / "latin.cpp", b"// \xfcber\nint x;\n")),
    "nested XML": (
        "package.xml",
        lambda package: write(package / "package.xml", "<a>" * _DEEP + "</a>" * _DEEP),
    ),
    "malformed XML": ("package.xml", lambda package: write(package / "package.xml", "<package><name>x</nam")),
    "malformed CMake": ("CMakeLists.txt", lambda package: write(package / "CMakeLists.txt", 'project("x\nadd_exec(')),
    "malformed message": ("Bad.msg", lambda package: write(package / "msg" / "Bad.msg", "this is not = a [ message\n")),
    "unreadable": ("secret.cpp", unreadable),
    "broken link": ("gone.cpp", broken_link),
    "link loop": ("loop.cpp", link_loop),
}


def lines(text: str) -> list[dict[str, Any]]:
    """Return the objects of JSON Lines."""
    return [json.loads(line) for line in text.splitlines()]


@pytest.fixture
def kg(tmp_path: Path) -> Program:
    """Return the program in an empty folder."""
    return Program(tmp_path)


@pytest.fixture(scope="module")
def broken(tmp_path_factory: pytest.TempPathFactory) -> tuple[Run, Program]:
    """Return the build of a healthy package next to broken ones of each kind, and the program in its folder."""
    folder = tmp_path_factory.mktemp("broken")
    healthy(folder / "src" / "healthy")
    for number, (_, spoil) in enumerate(BROKEN.values()):
        spoil(healthy(folder / "src" / f"odd{number}", name=f"odd{number}"))
    program = Program(folder)
    return program("build", "src", "--problems"), program


def test_what_is_broken_costs_its_own_facts(broken: tuple[Run, Program]) -> None:
    """The build succeeds, with the node of the healthy package."""
    built, kg = broken
    assert built.code in {0, 1}, built.err
    assert "Traceback" not in built.err
    nodes = lines(kg("nodes", "--package", "healthy", "--json").out)
    assert [entry["name"] for node in nodes for entry in node["publishes"] if not entry["implicit"]] == ["chatter"]


@pytest.mark.parametrize("kind", BROKEN)
def test_what_is_broken_is_named(kind: str, broken: tuple[Run, Program]) -> None:
    """A broken file is reported with its package."""
    if kind == "unreadable" and os.geteuid() == 0:
        pytest.skip("root may read everything")
    place = f"odd{[*BROKEN].index(kind)}/.*{re.escape(BROKEN[kind][0])}"
    assert re.search(place, broken[0].err), broken[0].err


NESTED: Final = {
    "blocks": ("src/talker.cpp", _NODE.replace("ros::spin();", "if (argc) {" * _DEEP + "}" * _DEEP)),
    "parentheses": ("src/talker.cpp", _NODE.replace('"chatter"', "(" * _DEEP + '"chatter"' + ")" * _DEEP)),
    "calls": ("src/talker.cpp", _NODE.replace("ros::spin();", "x = " + "f(" * _DEEP + ")" * _DEEP + ";")),
    "namespaces": ("src/talker.cpp", _NODE + "namespace n {" * 500 + "}" * 500),
    "lists": ("scripts/odd.py", f"#!/usr/bin/env python3\nimport rospy\nx = {'[' * _DEEP}{']' * _DEEP}\n"),
    "conditions": (
        "CMakeLists.txt",
        "project(odd)\n" + "if(TRUE)\n" * _DEEP + "add_executable(talker src/talker.cpp)\n" + "endif()\n" * _DEEP,
    ),
}


@pytest.fixture(scope="module")
def nested(tmp_path_factory: pytest.TempPathFactory) -> tuple[Run, list[dict[str, Any]]]:
    """Return the build of a package for each kind of deep code, and its nodes."""
    folder = tmp_path_factory.mktemp("nested")
    for number, (name, content) in enumerate(NESTED.values()):
        write(healthy(folder / "src" / f"odd{number}", name=f"odd{number}") / name, content)
    program = Program(folder)
    return program("build", "src", "--problems"), lines(program("nodes", "--json").out)


@pytest.mark.parametrize("kind", NESTED)
def test_what_nests_deep_is_read_or_named(kind: str, nested: tuple[Run, list[dict[str, Any]]]) -> None:
    """Code nested 5,000 deep gives its node or is reported by name."""
    built, nodes = nested
    package = f"odd{[*NESTED].index(kind)}"
    assert built.code in {0, 1}, built.err
    assert "Traceback" not in built.err
    named = re.search(f"{package}/.*{re.escape(NESTED[kind][0])}", built.err)
    assert named or [one for one in nodes if one["package"] == package and len(one["publishes"]) > 1], built.err


def test_entities_of_xml_are_neither_expanded_nor_fetched(kg: Program, tmp_path: Path) -> None:
    """A manifest with an entity that names a local file is rejected; the file's text is not in the store."""
    write(tmp_path / "secret.txt", "the-secret-text")
    package = healthy(tmp_path / "src" / "odd", name="odd")
    declaration = f'<!DOCTYPE package [<!ENTITY leak SYSTEM "file://{tmp_path}/secret.txt">]>\n'
    manifest = _MANIFEST.format(name="odd").replace("A package.", "&leak;").split("\n", 1)
    write(package / "package.xml", manifest[0] + "\n" + declaration + manifest[1])
    assert "KG116" in kg("build", "src").err + kg("status", "--json").out
    assert "the-secret-text" not in kg("export").out


@pytest.mark.parametrize(
    "address", ["ext::sh -c 'touch pwned'", "--upload-pack=touch pwned", "-oProxyCommand=touch pwned"]
)
def test_no_address_runs_a_command(address: str, kg: Program, tmp_path: Path) -> None:
    """An address that would make git run a command is an error, and no command runs."""
    built = kg("build", "--", address)
    assert built.code in {2, 3}, built.err
    assert "Traceback" not in built.err
    assert not (tmp_path / "pwned").exists()


def test_python_of_the_sources_is_never_run(kg: Program, tmp_path: Path) -> None:
    """setup.py, scripts and .cfg files are read, never run."""
    package = healthy(tmp_path / "src" / "odd", name="odd")
    harm = f"#!/usr/bin/env python3\nopen({str(tmp_path / 'pwned')!r}, 'w')\n"
    for name in ("setup.py", "cfg/Odd.cfg", "scripts/odd.py", "launch/odd.launch.py"):
        write(package / name, harm)
        (package / name).chmod(0o755)
    assert kg("build", "src").code in {0, 1}
    assert not (tmp_path / "pwned").exists()


def test_control_characters_do_not_reach_the_terminal(kg: Program, tmp_path: Path) -> None:
    """Escape sequences in names from sources are made visible in the output."""
    package = healthy(tmp_path / "src" / "odd", name="odd")
    write(package / "src" / "talker.cpp", _NODE.replace("chatter", "\\x1b]0;owned\\x07chatter\x1b[31m"))
    built = kg("build", "src")
    shown = [built, kg("nodes"), kg("node", "talker"), kg("status")]
    assert not [run for run in shown if "\x1b" in run.out + run.err or "\x07" in run.out + run.err]


def test_links_do_not_lead_out_of_a_source(kg: Program, tmp_path: Path) -> None:
    """A link to a file outside the source is not followed."""
    write(tmp_path / "outside" / "secret.msg", "string the_secret_field\n")
    package = healthy(tmp_path / "src" / "odd", name="odd")
    (package / "msg").mkdir()
    (package / "msg" / "Secret.msg").symlink_to(tmp_path / "outside" / "secret.msg")
    (package / "out").symlink_to(tmp_path / "outside", target_is_directory=True)
    assert kg("build", "src").code in {0, 1}
    assert "the_secret_field" not in kg("export").out
