"""Hostile launch files: no code runs, no file is fetched or read outside the packages, and reading terminates."""

from __future__ import annotations

import json
import os
import sys
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final

import pytest
from cli.program import Program
from patience import patient

if TYPE_CHECKING:
    from collections.abc import Iterable

_MANIFEST: Final = (
    '<package format="2"><name>odd</name><version>1.0.0</version><description>A test.</description>'
    '<maintainer email="a@example.org">A</maintainer><license>MIT</license></package>'
)
_SECRET: Final = "the_secret_key: the-secret-text\n"  # noqa: S105 - of no use to anybody
_SECONDS: Final = 5.0
"""Limit of processor time in seconds for one file; each takes a fraction of it."""


def launch(*elements: str) -> str:
    """Return a launch file of XML."""
    return f"<launch>{''.join(elements)}</launch>"


def python(*body: str, top: str = "") -> str:
    """Return a launch file of Python; `body` ends with the returned expression."""
    *before, last = body
    lines = [*(f"    {line}" for line in before), f"    return LaunchDescription({last})"]
    begin = "import os\nfrom launch import LaunchDescription\nfrom launch.actions import *\n"
    begin += (
        "from launch.substitutions import *\nfrom launch.conditions import *\nfrom launch_ros.actions import Node\n"
    )
    return begin + top + "\ndef generate_launch_description():\n" + "\n".join(lines) + "\n"


_EXPRESSIONS: Final = (
    "__import__('os').system('touch PWNED')",
    "open('PWNED', 'w')",
    "().__class__.__bases__[0].__subclasses__()",
    "9**9**9**9",
    "'x'*10**12",
    "[0]*10**12",
    "'%1000000000d' % 1",
    "1&lt;&lt;10**10",
    "'ab'.replace('', 'x'*60000).replace('', 'y'*60000)",
)
_OUTSIDE: Final = ("/etc/passwd", "SECRET", "$(UP)SECRET", "$(P)/link.yaml", "$(P)/linked/secret.yaml", "$(P)/pipe")
_LAUGHS: Final = "".join(f"a{n}: &a{n} [{', '.join([f'*a{n - 1}'] * 9)}]\n" for n in range(1, 30))
_ENTITIES: Final = "".join(f'<!ENTITY a{n} "{f"&a{n - 1};" * 10}">' for n in range(1, 12))
_HARM: Final = "open('PWNED', 'w')\nos.system('touch PWNED')\nexec(\"open('PWNED', 'w')\")\n"
_LOADS: Final = "<rosparam file='$(find odd)/p.yaml'/>"
_TAGS: Final = "a: !!python/object/apply:os.system ['touch PWNED']\nb: !include SECRET\n"


def _ros1_paths() -> str:
    ends = [end.replace("$(UP)", "$(find odd)/" + "../" * 30).replace("$(P)", "$(find odd)") for end in _OUTSIDE]
    ends += ["$(find in)/linked/secret.yaml", "$(find in)/../../SECRET", "$(find linked)/secret.yaml"]
    kinds = ["<rosparam file='{}'/>", "<param name='t' textfile='{}'/>", "<include file='{}'/>"]
    kinds += ["<param name='c' command='cat {}'/>", "<param name='x' command='xacro {}'/>"]
    return launch(*(kind.format(end) for kind in kinds for end in ends))


def _ros2_paths() -> str:
    ends = [
        end.replace("$(UP)", "$(dirname)/" + "../" * 30).replace("$(P)", "$(find-pkg-share odd)") for end in _OUTSIDE
    ]
    ends += ["$(find-pkg-share in)/linked/secret.yaml", "$(find-pkg-share linked)/secret.yaml"]
    loads = "".join(f"<param from='{end}'/>" for end in ends)
    return launch(
        f"<node pkg='odd' exec='talker' name='n'>{loads}</node>",
        *(f"<include file='{end}'/><let name='a' value='$(file-content {end})'/>" for end in ends),
        *(f"<let name='b' value=\"$(command 'cat {end}')\"/>" for end in ends),
    )


def _fan(first: str, ending: str, text: str) -> dict[str, str]:
    """Return files that each include the next one eight times."""
    files = {f"launch/f{n}{ending}": launch(text.format(n + 1) * 8) for n in range(1, 30)}
    return {f"launch/main{ending}": launch(first * 8), **files}


FILES: Final[dict[str, dict[str, str]]] = {
    "commands": {
        "launch/main.launch": launch(
            "<param name='a' command='touch PWNED'/><param name='b' command='cat x; touch PWNED'/>",
            "<param name='c' command='$(find xacro)/xacro `touch PWNED`'/>",
            "<node pkg='odd' type='talker' name='n' launch-prefix='touch PWNED'/>",
        )
    },
    "expressions of ROS 1": {
        "launch/main.launch": launch(
            *(f'<arg name="a{n}" default="$(eval {text})"/>' for n, text in enumerate(_EXPRESSIONS))
        )
    },
    "expressions of ROS 2": {
        "launch/main.launch.xml": launch(
            *(
                f"<let name='a' value='$(eval &quot;{text.replace(chr(39), '&apos;')}&quot;)'/>"
                for text in _EXPRESSIONS
            ),
            "<let name='c' value=\"$(command 'touch PWNED')\"/><executable cmd='touch PWNED'/>",
        )
    },
    "paths of ROS 1": {"launch/main.launch": _ros1_paths()},
    "paths of ROS 2": {"launch/main.launch.xml": _ros2_paths()},
    "entities": {"launch/main.launch": f'<!DOCTYPE l [<!ENTITY a0 "ha">{_ENTITIES}]>{launch("<arg name=&a11;/>")}'},
    "entities outside": {
        "launch/main.launch.xml": f"<!DOCTYPE l [<!ENTITY x SYSTEM 'file://SECRET'>]>{launch('<log message=&x;/>')}"
    },
    "aliases of ROS 1": {"launch/main.launch": launch(_LOADS), "p.yaml": f"a0: &a0 [1]\n{_LAUGHS}"},
    "tags of ROS 1": {"launch/main.launch": launch(_LOADS), "p.yaml": _TAGS},
    "tags of launch": {"launch/main.launch.yaml": f"launch:\n- arg:\n    {_TAGS.partition(chr(10))[0]}\n"},
    "long parameters": {
        "launch/main.launch": launch(_LOADS * 50),
        "p.yaml": "".join(f"k{n}: [1, {{a: b}}]\n" for n in range(20_000)),
    },
    "cycle": {
        "launch/main.launch": launch("<include file='$(find odd)/launch/b.launch'/>"),
        "launch/b.launch": launch("<include file='$(find odd)/launch/main.launch'/>"),
    },
    "fan of ROS 1": _fan(
        "<include file='$(find odd)/launch/f1.launch'/>", ".launch", "<include file='$(find odd)/launch/f{}.launch'/>"
    ),
    "fan of ROS 2": _fan(
        "<include file='$(dirname)/f1.launch.xml'/>", ".launch.xml", "<include file='$(dirname)/f{}.launch.xml'/>"
    ),
    "remappings of all nodes": {
        "launch/main.launch": launch(
            *(f"<remap from='a{n}' to='b{n}'/>" for n in range(2000)),
            *(f"<node pkg='odd' type='talker' name='n{n}'/>" for n in range(2000)),
        )
    },
    "long files again and again": {
        "launch/main.launch.xml": launch("<include file='$(dirname)/b.launch.xml'/>" * 1000),
        "launch/b.launch.xml": f"<launch><!--{'x' * 2_000_000}--></launch>",
    },
    "wildcards": {
        "launch/main.launch.xml": launch(
            f"<node pkg='odd' exec='talker' name='n' namespace='{'/a' * 60}'>",
            "<param from='$(dirname)/../p.yaml'/></node>",
        ),
        "p.yaml": f"{'/**/a' * 20}/b:\n  ros__parameters: {{x: 1}}\n",
    },
    "code of Python": {
        "launch/main.launch.py": python(
            *_HARM.splitlines(),
            "text = open('SECRET').read()",
            "[OpaqueFunction(function=run), Node(package='odd', executable=text, parameters=['SECRET'])]",
            top=f"from .more import *\n{_HARM}def run(context):\n    {_HARM.splitlines()[1]}\n    return []\n",
        ),
        "launch/more.py": f"import os\n{_HARM}",
    },
    "loops of Python": {
        "launch/main.launch.py": python(
            "for a in range(10**9):", "    x = [a for b in range(10**9)]", "while True:", "    a += 1", "[]"
        )
    },
    "recursion of Python": {
        "launch/main.launch.py": python("[f(1)]", top="def f(n):\n    return f(n + 1) + f(n + 2)\n")
    },
    "functions in functions": {
        "launch/main.launch.py": python(
            "[OpaqueFunction(function=f)]",
            top="def f(context):\n    return [OpaqueFunction(function=f), OpaqueFunction(function=f)]\n",
        )
    },
    "texts that double": {
        "launch/main.launch.py": python(
            "x = ['a']",
            "for i in range(60):",
            "    x = [PathJoinSubstitution([PathJoinSubstitution(x), PathJoinSubstitution(x)])]",
            "[Node(package='odd', executable=x)]",
        )
    },
    "conditions that double": {
        "launch/main.launch.py": python(
            "c = 'true'",
            "for i in range(60):",
            "    c = OrSubstitution(c, c)",
            "[Node(package='odd', executable='talker', condition=IfCondition(c))]",
        )
    },
    "parameters that double": {
        "launch/main.launch.py": python(
            "d = {'a': 1}",
            "for i in range(60):",
            "    d = {'a': d, 'b': d}",
            "[Node(package='odd', executable='talker', parameters=[d])]",
        )
    },
}


def _write(folder: Path, files: dict[str, str], words: Iterable[tuple[str, str]]) -> None:
    for name, text in {**files, "package.xml": _MANIFEST}.items():
        for word, meant in words:
            text = text.replace(word, meant)  # noqa: PLW2901 - word by word
        (folder / name).parent.mkdir(parents=True, exist_ok=True)
        (folder / name).write_text(text)


@pytest.fixture(scope="module")
def site(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with a package for each case, installed packages with links out of them, and a file outside."""
    folder = tmp_path_factory.mktemp("site")
    outside = folder / "outside"
    _write(outside, {"secret.yaml": _SECRET}, ())
    _write(folder / "share" / "in", {}, ())
    (folder / "share" / "in" / "linked").symlink_to(outside)
    (folder / "share" / "linked").symlink_to(outside)
    words = (("PWNED", str(folder / "pwned")), ("SECRET", str(outside / "secret.yaml")))
    for name, files in FILES.items():
        package = folder / "src" / name
        _write(package, files, words)
        (package / "link.yaml").symlink_to(outside / "secret.yaml")
        (package / "linked").symlink_to(outside)
        os.mkfifo(package / "pipe")
    return folder


@pytest.fixture(scope="module")
def found(site: Path) -> dict[str, Any]:
    """The side effects of reading each file."""
    run = Program(site).python(
        str(Path(__file__).with_name("hostile_launches.py")), str(site / "src"), str(site / "share")
    )
    assert run.code == 0, run.err
    answer: dict[str, Any] = json.loads(run.out)
    return answer


@pytest.mark.parametrize("case", FILES)
def test_launch_files_are_never_run(case: str, site: Path, found: dict[str, Any]) -> None:
    """Reading a launch file starts no process, opens no connection and writes no file."""
    assert not found[case]["begun"]
    assert not (site / "pwned").exists()


@pytest.mark.parametrize("case", FILES)
def test_launch_files_read_nothing_outside(case: str, site: Path, found: dict[str, Any]) -> None:
    """Only files of the package, of installed packages and of Python are opened; no outside text is stored."""
    allowed = (
        f"{site.resolve() / 'src' / case}/",
        sys.prefix,
        sys.base_prefix,
        str(Path(__file__).resolve().parents[1]),
    )
    assert not [path for path in found[case]["opened"] if not path.startswith(allowed) and "<" not in path]
    assert "secret-text" not in found[case]["text"]
    assert "root:" not in found[case]["text"]


@pytest.mark.parametrize("case", FILES)
def test_launch_files_are_read_to_an_end(case: str, found: dict[str, Any]) -> None:
    """Repetition, doubling and recursion are cut off quickly and with a small result."""
    assert found[case]["seconds"] < patient(_SECONDS)
    assert len(found[case]["text"]) < 64 << 20
    assert case != "cycle" or "cycle" in found[case]["text"]
