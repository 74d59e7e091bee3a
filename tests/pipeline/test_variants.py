"""Launch files with each boolean argument inverted, and with environment variables that enable branches."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest

from kg.errors import UsageError
from kg.lint.question import Question
from kg.lint.running import check_store
from kg.pipeline.build import build
from kg.pipeline.variants import MOST_VARIANTS, united, variants
from kg.settings import load
from kg.store.embedded import EmbeddedStore
from kg.store.opening import existing, writable

if TYPE_CHECKING:
    from pathlib import Path

    from kg.settings import Settings

MANIFEST = """<package format='2'><name>rover</name><version>1.0.0</version><buildtool_depend>catkin</buildtool_depend>
</package>"""
LAUNCH = """<launch>
  <arg name="camera" default="false"/>
  <arg name="fast" default="true"/>
  <arg name="robot" default="one"/>
  <arg name="deep" default="false"/>
  <node pkg="rover" type="base" name="base">
    <remap from="speed" to="speed_limited" unless="$(arg fast)"/>
  </node>
  <node pkg="rover" type="eye" name="eye" if="$(arg camera)"/>
  <node pkg="rover" type="arm" name="arm" if="$(optenv ROVER_ARM 0)"/>
  <include file="$(find rover)/launch/gone.launch" if="$(arg deep)"/>
</launch>
"""
BASE = """#!/usr/bin/env python
import rospy
from std_msgs.msg import String
rospy.init_node("base")
rospy.Publisher("speed", String, queue_size=1)
"""


@pytest.fixture
def settings(tmp_path: Path) -> Settings:
    """Return the settings of a store with one package."""
    package = tmp_path / "src" / "rover"
    for folder in ("launch", "scripts"):
        (package / folder).mkdir(parents=True)
    (package / "package.xml").write_text(MANIFEST)
    (package / "CMakeLists.txt").write_text(
        "project(rover)\ncatkin_package()\ncatkin_install_python(PROGRAMS scripts/base)\n"
    )
    (package / "launch" / "rover.launch").write_text(LAUNCH)
    (package / "scripts" / "base").write_text(BASE)
    (package / "scripts" / "base").chmod(0o755)
    found = load({"store": str(tmp_path / ".kg")}, environment={}, folder=tmp_path)
    with writable(found) as store:
        build([str(tmp_path / "src")], store, found)
    return found


def test_each_boolean_argument_and_variable_is_tried_alone(settings: Settings) -> None:
    """Arguments that are not booleans, and those that are given, are unchanged."""
    found = variants(settings, existing(settings), "rover.launch", {"deep": "false"}, {})
    assert [label for label, _ in found.others] == ["camera:=true", "fast:=false", "ROVER_ARM=1"]
    assert [one.name for one in found.system.instances] == ["/base"]


def test_what_only_variants_have_says_in_which(settings: Settings) -> None:
    """Nodes and names of a variant are added to those of the defaults."""
    system = united(variants(settings, existing(settings), "rover.launch", {}, {}))
    assert {one.name: one.started.condition for one in system.instances} == {
        "/base": None,
        "/eye": "camera:=true",
        "/arm": "ROVER_ARM=1",
    }
    base = next(one for one in system.instances if one.name == "/base")
    names = {end.resolved: end.reason for end in base.interfaces if not end.declared.implicit}
    assert names == {"/speed": None, "/speed_limited": "only with fast:=false"}


def test_findings_of_variants_say_in_which(settings: Settings, tmp_path: Path) -> None:
    """The missing file is found although only a variant includes it; the defaults' findings are unchanged."""
    usual = check_store(settings, Question("rover.launch"), tmp_path).report.findings
    checked = check_store(settings, Question("rover.launch", variants=True), tmp_path).report.findings
    assert set(usual) <= set(checked)
    (missing,) = [one for one in checked if "gone.launch" in one.message]
    assert missing.message.endswith("(only with deep:=true)")


def test_there_are_not_too_many_variants(settings: Settings, tmp_path: Path) -> None:
    """Variants above a limit are listed and not evaluated."""
    file = tmp_path / "src" / "rover" / "launch" / "rover.launch"
    many = "".join(f'<arg name="flag{number:02}" default="false"/>' for number in range(MOST_VARIANTS + 2))
    file.write_text(f"<launch>{many}</launch>")
    found = variants(settings, existing(settings), "rover.launch", {}, {})
    assert len(found.others) == MOST_VARIANTS
    assert found.left_out == (f"flag{MOST_VARIANTS}:=true", f"flag{MOST_VARIANTS + 1}:=true")


def test_variants_are_those_of_one_launch_file(settings: Settings, tmp_path: Path) -> None:
    """Without a launch file there is an error."""
    with pytest.raises(UsageError, match="needs a launch file"):
        check_store(settings, Question(variants=True), tmp_path)
    assert isinstance(existing(settings), EmbeddedStore)
