"""Types known in advance, and types learned from peers."""

from __future__ import annotations

import json
import subprocess
from pathlib import Path

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from patience import patient

from kg.errors import RobotError
from kg.robot.messages import Types

DEBIAN = Path("/usr/lib/python3/dist-packages")
SUMS = """
import importlib, json, os, sys
sums = {}
for package in os.listdir(sys.argv[1]):
    for sort in ("msg", "srv"):
        if os.path.isdir(os.path.join(sys.argv[1], package, sort)):
            try:
                module = importlib.import_module(package + "." + sort)
            except ImportError:
                continue
            for one in vars(module).values():
                if isinstance(one, type) and hasattr(one, "_md5sum") and hasattr(one, "_type"):
                    name = one._type
                    if sort == "srv" and not hasattr(one, "_request_class"):
                        name = name.replace("Request", "_Request").replace("Response", "_Response")
                    sums[name] = one._md5sum
json.dump(sums, sys.stdout)
"""
SEPARATOR = "=" * 80


@pytest.mark.ros
@pytest.mark.skipif(not (DEBIAN / "std_msgs" / "msg").is_dir(), reason="Debian's ROS 1 messages are not installed")
def test_sums_are_those_of_debian() -> None:
    """The MD5 sums of all message and service types installed by Debian equal those of kg."""
    environment = {"PATH": "/usr/bin:/bin", "PYTHONDONTWRITEBYTECODE": "1", "LC_ALL": "C.UTF-8"}
    answer = subprocess.run(
        ["/usr/bin/python3", "-c", SUMS, str(DEBIAN)],
        env=environment,
        capture_output=True,
        check=True,
        timeout=patient(30),
    )
    sums = json.loads(answer.stdout)
    types = Types(1)
    assert len(sums) > 50
    assert {name: types.md5(name) for name in sums} == sums


@pytest.mark.parametrize(
    ("name", "ros", "sort"),
    [
        ("std_srvs/SetBool", 1, "srv"),
        ("std_srvs/SetBool", 2, "srv"),
        ("move_base_msgs/MoveBase", 1, "action"),
        ("move_base_msgs/MoveBaseActionGoal", 1, "msg"),
        ("nav2_msgs/NavigateToPose", 2, "action"),
        ("nav2_msgs/NavigateToPose_SendGoal_Request", 2, "msg"),
        ("ardrone_autonomy/Navdata", 1, "msg"),
        ("ar_track_alvar_msgs/AlvarMarkers", 1, "msg"),
        ("no_msgs/Nothing", 1, None),
    ],
)
def test_sorts(name: str, ros: int, sort: str | None) -> None:
    """Common messages, services and actions are known, and distinguished."""
    assert Types(ros).sort(name) == sort


@pytest.mark.parametrize("ros", [1, 2])
def test_every_text_of_the_library_is_a_definition(ros: int) -> None:
    """Every type shipped with kg has fields, a definition and an encoding of its default value."""
    types = Types(ros)
    for index, name in enumerate(types.names()):
        if index % 8:
            types.fields(name)
        else:
            assert types.decode(name, types.encode(name, {})) == types.complete(name, {})


def test_names_of_parts_of_actions_of_ros_1() -> None:
    """The goal of an action has the name of ROS 1, and the one shared by ROS 1 and 2."""
    types = Types(1)
    assert types.md5("move_base_msgs/MoveBase_Goal") == types.md5("move_base_msgs/MoveBaseGoal")
    types.define("a/Walk", "int32 steps\n---\nbool arrived\n---\nint32 step", "action")
    assert types.sort("a/Walk") == "action"
    assert [field.type for field in types.fields("a/WalkActionGoal")] == [
        "std_msgs/Header",
        "actionlib_msgs/GoalID",
        "a/WalkGoal",
    ]


def test_definition_of_a_peer_counts_more_than_the_library() -> None:
    """A robot may have another version of a package than kg; the first definition received wins."""
    types = Types(1)
    before = types.md5("ardrone_autonomy/Navdata")
    types.define("ardrone_autonomy/Navdata", "Header header\nfloat32 batteryPercent\n")
    assert types.md5("ardrone_autonomy/Navdata") != before
    assert types.complete("ardrone_autonomy/Navdata", {})["batteryPercent"] == 0
    with pytest.raises(RobotError) as caught:
        types.define("ardrone_autonomy/Navdata", "Header header\nfloat64 batteryPercent\n")
    assert caught.value.code == "KG806"


def test_definition_of_a_peer_does_not_change_a_standard_type() -> None:
    """Types of every distribution cannot be redefined."""
    types = Types(1)
    with pytest.raises(RobotError) as caught:
        types.define("a/A", f"std_msgs/String s\n{SEPARATOR}\nMSG: std_msgs/String\nint8 data")
    assert caught.value.code == "KG806"
    assert not types.has("a/A")


def test_sum_keeps_the_text_of_constants() -> None:
    """Constants are summed as written, and comments are not: the rule of ROS."""
    types = Types(1)
    types.define("a/Hex", "# words\nuint8 A = 0x10 # more\nstring B= text # of it \nuint8[] data # last\n")
    assert types.definition("a/Hex") == "uint8 A=0x10\nstring B=text # of it\nuint8[] data\n"


@pytest.mark.parametrize(
    "text",
    [
        "int8",
        "int8 a-b",
        "int8 __class__ ",
        "int8 a\nint8 a",
        "int8[99999999] a",
        "int8[-1] a",
        "int8 a\n\n" + SEPARATOR + "\nint8 b",
        f"{SEPARATOR}\nMSG: ../x\nint8 b",
        f"B b\n{SEPARATOR}\nMSG: a/B\nA a",
        f"B[] b\n{SEPARATOR}\nMSG: a/B\n",
        f"B[4000] b\n{SEPARATOR}\nMSG: a/B\nstring[400] s",
        "".join(f"T{n} a\n{SEPARATOR}\nMSG: a/T{n}\n" for n in range(3000)) + "int8 a",
        "int8 a\n" * 60_000,
        "\n".join(f"int8 a{n}" for n in range(9000)),
        "x" * 1_000_000,
    ],
)
def test_bad_definitions(text: str) -> None:
    """An invalid definition, or one with excessive sizes, is rejected with KG810."""
    with pytest.raises(RobotError) as caught:
        Types(1).define("a/A", text)
    assert caught.value.code == "KG810"


@pytest.mark.parametrize("name", ["", "a", "/a/b", "a/b/c", "a/b'", "a b/c", 'a/b"""', "ä/b"])
def test_names_that_are_none(name: str) -> None:
    """A name other than `package/Type` is rejected, and never becomes code."""
    types = Types(1)
    with pytest.raises(RobotError) as caught:
        types.define(name, "int8 a")
    assert caught.value.code == "KG810"
    with pytest.raises(RobotError) as caught:
        types.fields(name)
    assert caught.value.code == "KG804"


@given(st.text(alphabet=st.sampled_from("int8 []<=/#aZ_\n\r\t=MSG:string 0193\"'\\;()"), max_size=200))
@settings(max_examples=150, deadline=None)
def test_any_text_is_refused_or_learned(text: str) -> None:
    """Any text from a peer is learned, or rejected with a code."""
    types = SHARED
    name = f"fuzz/T{len(types.names())}"
    try:
        types.define(name, text)
        whole = types.decode(name, types.encode(name, {}))
    except RobotError as error:
        refused = error.code in {"KG804", "KG806", "KG810"}
    else:
        refused = whole == types.complete(name, {})
    assert refused


SHARED = Types(1)


def test_an_action_of_the_library_has_its_topics() -> None:
    """The message of a goal's topic is known whichever part of its action is requested first."""
    assert Types(1).md5("move_base_msgs/MoveBaseActionGoal") == "660d6895a1b9a16dce51fbdd9a64a56b"


@pytest.mark.parametrize("field", ["wstring words", "wstring[] words"])
def test_texts_of_wide_characters_are_named(field: str) -> None:
    """A definition with a `wstring` is rejected by that name, not as an unknown type."""
    with pytest.raises(RobotError) as wide:
        Types(2).define("a_msgs/Words", field)
    assert (wide.value.code, "16-bit characters" in wide.value.message) == ("KG804", True)
