"""A generator of Python programs whose interfaces are known by construction, for rospy and rclpy.

A program is a sequence of features, as in `extract.cpp.generated`: each has definitions of its own, statements that
run, and the names of the interfaces created by them. Interfaces that a feature only defines are not expected.
"""

from __future__ import annotations

import re
from dataclasses import dataclass
from typing import Final

from hypothesis import strategies as st

__all__ = ["FEATURES", "Feature", "Program", "Use", "composed", "programs"]

MESSAGES: Final = (("std_msgs", "String"), ("sensor_msgs", "Image"), ("my_msgs", "Feedback"), ("nav_msgs", "Path"))
_MAKE: Final = re.compile(r"MAKE\((?P<node>[\w.]+), (?P<name>(?:[^()]|\([^()]*\))*)\)")
_CREATED: Final = {
    (1, "publishes"): "rospy.Publisher({1}, {2}, queue_size=1)",
    (1, "subscribes"): "rospy.Subscriber({1}, {2}, done)",
    (2, "publishes"): "{0}.create_publisher({2}, {1}, 1)",
    (2, "subscribes"): "{0}.create_subscription({2}, {1}, done, 1)",
}
_READ: Final = {
    1: r"rospy.get_param('~\1', \2)",
    2: r"h.declare_parameter('\1', \2).value",
}
_PROGRAM: Final = {
    1: """import rospy
IMPORTS
def done(message): pass
DEFINITIONS
def main():
    rospy.init_node("demo")
    h = None
STATEMENTS
    rospy.spin()
if __name__ == "__main__":
    main()
""",
    2: """import rclpy
from rclpy.node import Node
IMPORTS
def done(message): pass
DEFINITIONS
class Demo(Node):
    def __init__(self):
        super().__init__("demo")
        self.set_up(self)
    def set_up(self, h):
STATEMENTS
def main():
    rclpy.init()
    rclpy.spin(Demo())
if __name__ == "__main__":
    main()
""",
}


@dataclass(frozen=True)
class Feature:
    """Python with `#` for a number of its own and `MESSAGE` for the type; the statements have the node as `h`.

    `MAKE(node, name)` creates the interface, `READ(name, default)` reads a parameter. `ros` is the version of ROS that
    it is for; 0 for both.
    """

    statements: str
    names: tuple[str, ...]
    definitions: str = ""
    ros: int = 0


@dataclass(frozen=True)
class Use:
    """A feature in a program, by its name: with its role and message type."""

    feature: str
    role: str = "publishes"
    message: tuple[str, str] = MESSAGES[0]


@dataclass(frozen=True)
class Program:
    """The text of a program, and role, name and type of its interfaces."""

    source: str
    ends: frozenset[tuple[str, str, str]]


_MADE: Final = """class Made#:
    def __init__(self, g, name):
        self.made = MAKE(g, name)
    def never(self):
        MAKE(self, "never#")
"""
FEATURES: Final = {
    "in place": Feature('MAKE(h, "n#")', ("n#",)),
    "absolute": Feature('MAKE(h, "/n#")', ("/n#",)),
    "private": Feature('MAKE(h, "~n#")', ("~/n#",), ros=1),
    "private name": Feature('MAKE(h, "~/n#")', ("~/n#",), ros=2),
    "partial": Feature('MAKE(h, "n#/" + foreign_text() + "/end")', ("n#/{}/end",)),
    "formatted": Feature('MAKE(h, f"n#/{foreign_text()}/end")', ("n#/{}/end",)),
    "parameter": Feature('topic = READ("topic#", "n#")\nMAKE(h, topic)', ("n#",)),
    "object": Feature('made = Made#(h, "n#")', ("n#",), _MADE),
    "objects in a list": Feature('all = [Made#(h, name) for name in ("n#/a", "n#/b")]', ("n#/a", "n#/b"), _MADE),
    "objects in a dictionary": Feature(
        'all = {}\nfor one in ("a", "b"):\n    all[one] = Made#(h, "n#/" + one)', ("n#/a", "n#/b"), _MADE
    ),
    "passed in": Feature(
        "user = User#(foreign_object(), h)",
        ("n#",),
        """class Given#:
    def __init__(self, g):
        MAKE(g, "never#")
    def start(self):
        MAKE(self, "late#")
class User#:
    def __init__(self, given, g):
        self.given = given
        MAKE(g, "n#")
        self.given.start()
""",
    ),
    "wrapper": Feature('wrap#(h, "n#")', ("w/n#",), 'def wrap#(g, name):\n    return MAKE(g, "w/" + name)\n'),
    "default arguments": Feature(
        'MAKE(h, full#("a"))\nMAKE(h, full#("b", outer="own#"))',
        ("usual#/a", "own#/b"),
        'def full#(name, outer="usual#"):\n    return outer + "/" + name\n',
    ),
    "arguments by name": Feature('wrap#(name="n#", g=h)', ("n#",), "def wrap#(g, name):\n    return MAKE(g, name)\n"),
    "arguments spread": Feature(
        'wrap#(*[h, "n#"])\nwrap#(**{"g": h, "name": "m#"})',
        ("n#", "m#"),
        "def wrap#(g, name):\n    return MAKE(g, name)\n",
    ),
    "forwarded": Feature(
        'outer#(h, "n#", end="e")',
        ("n#/e",),
        "def outer#(*args, **kwargs):\n    return inner#(*args, **kwargs)\n"
        'def inner#(g, name, end="x"):\n    return MAKE(g, name + "/" + end)\n',
    ),
    "never called": Feature("if False:\n    lonely#(h)", (), 'def lonely#(g):\n    MAKE(g, "never#")\n'),
    "overriding": Feature(
        "Derived#().start(h)",
        ("n#",),
        """class Base#:
    def name(self):
        return "base#"
    def start(self, g):
        MAKE(g, self.name())
class Derived#(Base#):
    def name(self):
        return "n#"
""",
    ),
    "super": Feature(
        "Derived#(h)",
        ("n#/base", "n#/own"),
        """class Base#:
    def __init__(self, g, name):
        self.name = name
        MAKE(g, self.name + "/base")
class Derived#(Base#):
    def __init__(self, g):
        super().__init__(g, "n#")
        MAKE(g, self.name + "/own")
""",
    ),
    "factory": Feature(
        'build#("right")(h)',
        ("right#",),
        """def left#(g):
    MAKE(g, "left#")
def right#(g):
    MAKE(g, "right#")
def build#(name):
    return {"left": left#, "right": right#}[name]
""",
    ),
    "property": Feature(
        "MAKE(h, Named#().name)",
        ("n#",),
        'class Named#:\n    @property\n    def name(self):\n        return "n#"\n',
    ),
    "static and class methods": Feature(
        "MAKE(h, Named#.first())\nMAKE(h, Named#.second())",
        ("n#", "m#"),
        """class Named#:
    NAME = "m#"
    @staticmethod
    def first():
        return "n#"
    @classmethod
    def second(cls):
        return cls.NAME
""",
    ),
    "data class": Feature(
        'MAKE(h, Row#("n#").name)\nMAKE(h, Row#("m#", end="e").end + "#")',
        ("n#", "e#"),
        '@dataclass\nclass Row#:\n    name: str\n    end: str = "x"\n',
    ),
    "enumeration": Feature(
        "MAKE(h, Names#.FIRST.value)", ("n#",), 'class Names#(Enum):\n    FIRST = "n#"\n    SECOND = "never#"\n'
    ),
    "decorated": Feature(
        'made#(h, "n#")',
        ("n#",),
        """def logged#(function):
    @functools.wraps(function)
    def inner(*args, **kwargs):
        return function(*args, **kwargs)
    return inner
@logged#
def made#(g, name):
    return MAKE(g, name)
""",
    ),
    "decorated with arguments": Feature(
        'made#(h, "n#")',
        ("p#/n#",),
        """def prefixed#(prefix):
    def decorate(function):
        def inner(g, name):
            return function(g, prefix + "/" + name)
        return inner
    return decorate
@prefixed#("p#")
def made#(g, name):
    return MAKE(g, name)
""",
    ),
    "cached": Feature(
        "MAKE(h, name#())", ("n#",), '@functools.lru_cache(maxsize=None)\ndef name#():\n    return "n#"\n'
    ),
    "generator": Feature(
        "for one in names#():\n    MAKE(h, one)",
        ("n#/a", "n#/b"),
        'def names#():\n    yield "n#/a"\n    yield "n#/b"\n',
    ),
    "generator over a list": Feature(
        "for one in names#(['a', 'b']):\n    MAKE(h, one)",
        ("n#/a", "n#/b"),
        'def names#(all):\n    for one in all:\n        yield "n#/" + one\n',
    ),
    "generator of generators": Feature(
        "for one in list(names#()):\n    MAKE(h, one)",
        ("n#/a", "n#/b"),
        "def parts#():\n    yield from ['a', 'b']\ndef names#():\n    yield from ('n#/' + one for one in parts#())\n",
    ),
    "context manager": Feature(
        "with opened#('n#') as name:\n    MAKE(h, name)",
        ("n#",),
        "@contextlib.contextmanager\ndef opened#(name):\n    yield name\n",
    ),
    "lambda": Feature('make = lambda name: MAKE(h, name + "/l")\nmake("n#")', ("n#/l",)),
    "partial function": Feature(
        'make = functools.partial(wrap#, h)\nmake("n#")', ("n#",), "def wrap#(g, name):\n    return MAKE(g, name)\n"
    ),
    "closure": Feature(
        'outer#(h)("n#")',
        ("c/n#",),
        'def outer#(g):\n    prefix = "c/"\n    def inner(name):\n        MAKE(g, prefix + name)\n    return inner\n',
    ),
    "handed back": Feature(
        "names = []\nfill#(names)\nfor one in names:\n    MAKE(h, one)",
        ("n#",),
        'def fill#(out):\n    out.append("n#")\n',
    ),
    "early return": Feature(
        "ends#(h)",
        ("n#",),
        'def ends#(g):\n    MAKE(g, "n#")\n    if 2 > 1:\n        return\n    MAKE(g, "never#")\n',
    ),
    "branch, foreign": Feature(
        'if foreign_flag():\n    MAKE(h, "n#/yes")\nelse:\n    MAKE(h, "n#/no")', ("n#/yes", "n#/no")
    ),
    "branch, known": Feature('size = 3\nif size > 2:\n    MAKE(h, "n#/yes")\nelse:\n    MAKE(h, "n#/no")', ("n#/yes",)),
    "choice of names": Feature('name = "l#" if foreign_flag() else "r#"\nMAKE(h, name + "/c")', ("l#/c", "r#/c")),
    "loop over a list": Feature('for one in ["a", "b"]:\n    MAKE(h, "n#/" + one)', ("n#/a", "n#/b")),
    "loop over numbers": Feature("for k in range(3):\n    MAKE(h, f'n#/{k}')", ("n#/0", "n#/1", "n#/2")),
    "loop over pairs": Feature(
        'for key, value in {"a": "x", "b": "y"}.items():\n    MAKE(h, "n#/%s%s" % (key, value))', ("n#/ax", "n#/by")
    ),
    "loop that is left": Feature(
        'for one in ["a", "b", "c", "d"]:\n    if one == "b":\n        continue\n'
        '    MAKE(h, "n#/" + one)\n    if one == "c":\n        break',
        ("n#/a", "n#/c"),
    ),
    "while": Feature('k = 0\nwhile k < 2:\n    MAKE(h, "n#/" + str(k))\n    k += 1', ("n#/0", "n#/1")),
    "exception": Feature('try:\n    raise ValueError()\nexcept ValueError:\n    MAKE(h, "n#")', ("n#",)),
}


def composed(ros: int, uses: list[Use]) -> Program:
    """Return the program with these features, in this order."""
    definitions, statements, ends = [], [], set()
    suffix = ".msg"
    imports = ["import contextlib", "import functools", "from dataclasses import dataclass", "from enum import Enum"]
    imports += [f"from {package}{suffix} import {name}" for package, name in sorted({use.message for use in uses})]
    for number, use in enumerate(uses):
        feature = FEATURES[use.feature]
        created = _CREATED[ros, use.role]

        def filled(text: str, number: int = number, use: Use = use, created: str = created) -> str:
            text = _MAKE.sub(lambda made: created.format(made["node"], made["name"], use.message[1]), text)
            text = re.sub(r'READ\("([^"]*)", ([^()]*)\)', _READ[ros], text)
            return text.replace("#", str(number))

        definitions.append(filled(feature.definitions))
        depth = " " * (4 if ros == 1 else 8)
        statements += [depth + line for line in filled(feature.statements).splitlines()]
        ends |= {(use.role, filled(name), "/".join(use.message)) for name in feature.names}
    source = _PROGRAM[ros].replace("IMPORTS", "\n".join(imports)).replace("DEFINITIONS", "".join(definitions))
    return Program(source.replace("STATEMENTS", "\n".join(statements)), frozenset(ends))


@st.composite
def programs(draw: st.DrawFn) -> Program:
    """Return a program of one to five features."""
    ros = draw(st.sampled_from([1, 2]))
    use = st.builds(
        Use,
        st.sampled_from([name for name, feature in FEATURES.items() if feature.ros in (0, ros)]),
        st.sampled_from(["publishes", "subscribes"]),
        st.sampled_from(MESSAGES),
    )
    return composed(ros, draw(st.lists(use, min_size=1, max_size=5)))
