from __future__ import annotations

from typing import TYPE_CHECKING

import pytest
from extract.python.programs import nodes_of

if TYPE_CHECKING:
    from pathlib import Path

HEAD = "import rospy\nfrom std_msgs.msg import String\n"


def names(root: Path, text: str) -> list[str | None]:
    """Return the names of all interfaces of the one node in a script."""
    [node] = nodes_of(root, {"scripts/a.py": HEAD + text})
    return [interface.name for interface in node.node.interfaces]


def test_a_long_chain_of_classes_is_followed(tmp_path: Path) -> None:
    """Inheritance over many classes, and a class that is its own base, are read."""
    chain = "class C0(C0): pass\n" + "".join(f"class C{n}(C{n - 1}): pass\n" for n in range(1, 900))
    assert names(tmp_path, f"{chain}rospy.init_node('a')\nC899()\nrospy.Publisher('p', String)\n") == ["p"]


def test_deep_nesting_is_read(tmp_path: Path) -> None:
    """Thousands of levels of parentheses, attributes, conditions and calls are read."""
    text = (
        "rospy.init_node('a')\n"
        f"a = {'(' * 5000}1{')' * 5000}\nb = x{'.y' * 5000}\n{'x' + '.y' * 5000}.Publisher('q', String)\n"
        f"c = {'not ' * 5000}a\nd = {'f(' * 5000}{')' * 5000}\n"
        f"if {'not ' * 5000}a:\n    rospy.Publisher('p', String)\n"
        f"rospy.Publisher({'-' * 5000}1, String)\nrospy.Publisher({'[' * 5000}{']' * 5000}, String)\n"
        f"rospy.Publisher({' or '.join(['None'] * 3000)} or 'r', String)\n"
    )
    assert "p" in names(tmp_path, text)


def test_recursion_ends(tmp_path: Path) -> None:
    """Functions that call themselves or each other run a bounded number of times."""
    text = (
        "def f(n):\n    rospy.Publisher('f', String)\n    g(n + '/x')\n"
        "def g(n):\n    rospy.Publisher(n, String)\n    f(n)\n    g(n + 'y')\n"
        "rospy.init_node('a')\nf('s')\n"
    )
    found = names(tmp_path, text)
    assert "f" in found
    assert len(found) < 200


def test_a_broken_file_does_not_hide_the_rest(tmp_path: Path) -> None:
    """Only the line with a syntax error is lost."""
    assert names(tmp_path, "rospy.init_node('a')\nx = = (\nrospy.Publisher('p', String)\n") == ["p"]


def test_every_run_gives_the_same(tmp_path: Path) -> None:
    """Reading twice gives equal nodes in the same order."""
    text = HEAD + "class A:\n  def a(self): rospy.Publisher('a', String)\n  def b(self): rospy.Publisher('b', String)\n"
    files = {
        "scripts/a.py": f"{text}rospy.init_node('a')\nA()\n",
        "scripts/b.py": f"{text}rospy.init_node('b')\nA().b()\n",
    }
    assert nodes_of(tmp_path, files) == nodes_of(tmp_path, files)
    assert [extracted.node.name for extracted in nodes_of(tmp_path, files)] == ["a", "b"]


def test_a_base_initialised_by_its_name_reaches_the_one_behind_it(tmp_path: Path) -> None:
    """`super()` in `Base.__init__(self)` refers to the bases of `Base`."""
    text = """import rclpy
from rclpy.node import Node
from std_msgs.msg import String

class Base(Node):
    def __init__(self, name):
        super().__init__(name)
        self.create_publisher(String, 'out', 1)

class Viewer(Base):
    def __init__(self, *args):
        Base.__init__(self, *args)

rclpy.init()
Viewer('viewer')
"""
    found = next(one for one in nodes_of(tmp_path, {"scripts/view.py": text}) if one.node.name == "view")
    assert (found.node.node_name, [one.name for one in found.node.interfaces]) == ("viewer", ["out"])


MADE = "from nav2_simple_commander.robot_navigator import BasicNavigator\npilot = BasicNavigator('pilot')\n"
DERIVED = """import nav2_simple_commander.robot_navigator as nav
class Pilot(nav.BasicNavigator):
    def __init__(self):
        super().__init__(node_name="pilot")
pilot = Pilot()
"""


@pytest.mark.parametrize("code", [MADE, DERIVED])
def test_the_navigator_of_nav2_is_a_node(tmp_path: Path, code: str) -> None:
    """It has its action clients, although its sources are not in the build, and its given name."""
    (found,) = nodes_of(tmp_path, {"main.py": f"import rclpy\nrclpy.init()\n{code}rclpy.spin(pilot)\n"})
    named = {(one.role.value, one.name, one.type) for one in found.node.interfaces}
    assert ("action_clients", "navigate_to_pose", "nav2_msgs/NavigateToPose") in named
    assert ("publishes", "initialpose", "geometry_msgs/PoseWithCovarianceStamped") in named
    assert found.node.node_name == "pilot"
    assert found.node.ros == 2


def test_a_script_with_the_name_of_a_package_has_its_messages(tmp_path: Path) -> None:
    """`import work.srv` refers to the package, although the script nodes/work.py is found first."""
    text = "import work.srv\nrospy.init_node('a')\nrospy.ServiceProxy('start', work.srv.Start)\n"
    files = {"nodes/work.py": "import rospy\n", "nodes/a.py": HEAD + text}
    found = {item.type for node in nodes_of(tmp_path, files) for item in node.node.interfaces}
    assert found == {"work/Start"}


def test_a_service_in_lower_case_is_among_all_names_of_a_module(tmp_path: Path) -> None:
    """`from demo.srv import *` gives each service defined by the package, in any case."""
    files = {
        "srv/classify.srv": "---\n",
        "scripts/a.py": f"{HEAD}from demo.srv import *\nrospy.init_node('a')\nrospy.Service('s', classify, print)\n",
    }
    [node] = nodes_of(tmp_path, files)
    assert [item.type for item in node.node.interfaces] == ["demo/classify"]


@pytest.mark.parametrize(
    ("text", "found"),
    [
        ("from rospy import *\nfrom std_msgs.msg import *\ninit_node('a')\nPublisher('p', String)", "std_msgs/String"),
        ("from actionlib import *\nfrom w.msg import *\nSimpleActionClient('p', GoAction)", "w/Go"),
        ("from w.msg import *\nfrom w.srv import *\nrospy.ServiceProxy('p', Stop)", "w/Stop"),
    ],
)
def test_all_names_of_several_modules_are_told_apart(tmp_path: Path, text: str, found: str) -> None:
    """Described names belong to the framework; a type to the only package that could define it."""
    start = "" if "init_node" in text else "rospy.init_node('a')\n"
    [node] = nodes_of(tmp_path, {"scripts/a.py": f"import rospy\n{start}{text}\n"})
    assert [(item.name, item.type) for item in node.node.interfaces] == [("p", found)]
