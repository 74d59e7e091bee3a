"""A generator of C++ programs whose interfaces are known by construction, for ROS 1 and ROS 2.

A program is a sequence of features. Each feature has classes and functions of its own, statements for the body that
sets the node up, and the names of the interfaces created by these statements. Interfaces that a feature only mentions
are not expected.
"""

from __future__ import annotations

import re
from dataclasses import dataclass
from typing import Final

from hypothesis import strategies as st

__all__ = ["FEATURES", "MESSAGES", "Feature", "Program", "Use", "composed", "programs"]

MESSAGES: Final = (("std_msgs", "String"), ("sensor_msgs", "Image"), ("my_msgs", "Feedback"), ("nav_msgs", "Path"))
_MAKE: Final = re.compile(r"MAKE(?:<(?P<type>\w+)>)?\((?P<handle>\w+), (?P<name>(?:[^()]|\([^()]*\))*)\)")
_CREATED: Final = {
    (1, "publishes"): "{0}.advertise<{1}>({2}, 1)",
    (1, "subscribes"): "{0}.subscribe<{1}>({2}, 1, done)",
    (2, "publishes"): "{0}->create_publisher<{1}>({2}, 1)",
    (2, "subscribes"): "{0}->create_subscription<{1}>({2}, 1, done)",
}
_READ: Final = {1: "h.param", 2: "h->declare_parameter"}
_HANDLE: Final = {1: "ros::NodeHandle&", 2: "rclcpp::Node*"}
_LEAD: Final = {
    1: 'ros::NodeHandle h(node, "{}");',
    2: 'auto held = node->create_sub_node("{}"); rclcpp::Node* h = held.get();',
}
_LEAD_OF_ROOT: Final = {1: "ros::NodeHandle& h = node;", 2: "rclcpp::Node* h = node;"}
_PROGRAM: Final = {
    1: """#include <ros/ros.h>
DECLARATIONS
int main(int argc, char** argv) {
  ros::init(argc, argv, "demo");
  ros::NodeHandle node;
STATEMENTS
  ros::spin();
}
""",
    2: """#include <rclcpp/rclcpp.hpp>
DECLARATIONS
class Demo : public rclcpp::Node {
public:
  Demo() : rclcpp::Node("demo") {
  rclcpp::Node* node = this;
STATEMENTS
  }
};
int main(int argc, char** argv) {
  rclcpp::init(argc, argv);
  rclcpp::spin(std::make_shared<Demo>());
}
""",
}


@dataclass(frozen=True)
class Feature:
    """C++ with `#` for a number of its own, `MESSAGE` for the type, `HANDLE` for the type of a node or node handle.

    `MAKE(handle, name)` creates the interface, `MAKE<M>(...)` with another type, `READ` reads a parameter. The
    statements have the handle as `h`. `ros` is the version of ROS that it is for; 0 for both.
    """

    statements: str
    names: tuple[str, ...]
    declarations: str = ""
    ros: int = 0


@dataclass(frozen=True)
class Use:
    """A feature in a program, by its name: with its namespace, role and message type."""

    feature: str
    namespace: str = ""
    role: str = "publishes"
    message: tuple[str, str] = MESSAGES[0]


@dataclass(frozen=True)
class Program:
    """The text of a program, and role, name and type of its interfaces."""

    source: str
    ends: frozenset[tuple[str, str, str]]


_NAMED: Final = """class Made# {
public:
  Made#(HANDLE g, const std::string& name) { MAKE(g, name); }
  void never(HANDLE g) { MAKE(g, "never#"); }
};"""
FEATURES: Final = {
    "in place": Feature('MAKE(h, "n#");', ("n#",)),
    "absolute": Feature('MAKE(h, "/n#");', ("/n#",)),
    "private handle": Feature('ros::NodeHandle own("~"); MAKE(own, "n#");', ("~/n#",), ros=1),
    "private name": Feature('MAKE(h, "~/n#");', ("~/n#",), ros=2),
    "partial": Feature('MAKE(h, "n#/" + foreign_text() + "/end");', ("n#/{foreign_text}/end",)),
    "parameter": Feature('std::string topic = READ<std::string>("topic#", "n#"); MAKE(h, topic);', ("n#",)),
    "object, value": Feature('Made# made(h, "n#");', ("n#",), _NAMED),
    "object, new": Feature('auto* made = new Made#(h, "n#");', ("n#",), _NAMED),
    "object, shared": Feature('auto made = std::make_shared<Made#>(h, "n#");', ("n#",), _NAMED),
    "object, reset": Feature('std::unique_ptr<Made#> made; made.reset(new Made#(h, "n#"));', ("n#",), _NAMED),
    "object, listed": Feature(
        'std::vector<std::shared_ptr<Made#>> all; all.push_back(std::make_shared<Made#>(h, "n#"));', ("n#",), _NAMED
    ),
    "member by value": Feature(
        "Outer# outer(h);",
        ("n#/v",),
        """struct Inner# { explicit Inner#(HANDLE g) { MAKE(g, name_ + "/v"); } std::string name_{"n#"}; };
struct Outer# { explicit Outer#(HANDLE g) : inner_(g) {} Inner# inner_; };""",
    ),
    "member by pointer": Feature(
        "Outer# outer(h);",
        ("n#",),
        """struct Inner# { explicit Inner#(HANDLE g) { MAKE(g, "never#"); } };
struct Outer# { explicit Outer#(HANDLE g) { MAKE(g, "n#"); } std::unique_ptr<Inner#> inner_; };""",
    ),
    "passed in": Feature(
        "User# user(foreign_object(), h);",
        ("n#",),
        """struct Given# {
  explicit Given#(HANDLE g) : g_(g) { MAKE(g, "never#"); }
  void start() { MAKE(g_, "late#"); }
  HANDLE g_;
};
struct User# {
  User#(std::shared_ptr<Given#> given, HANDLE g) : given_(given) { MAKE(g, "n#"); given_->start(); }
  std::shared_ptr<Given#> given_;
};""",
    ),
    "created behind an interface": Feature(
        "Uses# uses(std::make_shared<Does#>(), h);",
        ("n#",),
        """struct Task# { virtual ~Task#() = default; virtual void go(HANDLE g) = 0; };
struct Does# : Task# { void go(HANDLE g) override { MAKE(g, "n#"); } };
struct Uses# { Uses#(std::shared_ptr<Task#> task, HANDLE g) { task->go(g); } };""",
    ),
    "objects in a map": Feature(
        "std::map<std::string, std::unique_ptr<Made#>> all;"
        ' for (std::string one : {"a", "b"}) { all.emplace(one, std::make_unique<Made#>(h, "n#/" + one)); }',
        ("n#/a", "n#/b"),
        _NAMED,
    ),
    "only instance": Feature(
        "MAKE(h, Only#::get().name_);",
        ("n#",),
        """struct Only# {
  static Only#& get() { static Only# only; return only; }
  std::string name_ = "n#";
};""",
    ),
    "default arguments": Feature(
        'MAKE(h, full#("a")); MAKE(h, full#("b", "own#"));',
        ("usual#/a", "own#/b"),
        """std::string full#(const std::string& name, const std::string& outer = "usual#") {
  return outer + "/" + name;
}""",
    ),
    "stored function": Feature(
        'std::function<void(std::string)> make = [&](std::string name) { MAKE(h, name); }; make("n#");', ("n#",)
    ),
    "never called": Feature(
        "Alone# alone; if (false) { lonely#(h); }",
        (),
        """void lonely#(HANDLE g) { MAKE(g, "never#"); }
struct Alone# { void go(HANDLE g) { MAKE(g, "never#"); } };""",
    ),
    "wrapper": Feature(
        'wrap#<MESSAGE>(h, "n#");',
        ("w/n#",),
        'template <class M> void wrap#(HANDLE g, std::string name) { MAKE<M>(g, "w/" + name); }',
    ),
    "overloads": Feature(
        'over#(h, "n#", "x");',
        ("n#/x",),
        """void over#(HANDLE g, std::string name) { MAKE(g, "two/" + name); }
void over#(HANDLE g, std::string a, std::string b) { MAKE(g, a + "/" + b); }""",
    ),
    "method and function": Feature(
        'Both# both(h); both.make#("n#"); space#::make#(h, "m#");',
        ("free/by/n#", "free/m#"),
        """namespace space# { void make#(HANDLE g, std::string name) { MAKE(g, "free/" + name); } }
struct Both# {
  explicit Both#(HANDLE g) : g_(g) {}
  void make#(std::string name) { space#::make#(g_, "by/" + name); }
  HANDLE g_;
};""",
    ),
    "class template": Feature(
        'auto port = std::make_unique<Port#<MESSAGE>>(h, "n#");',
        ("n#",),
        "template <class M> struct Port# { Port#(HANDLE g, const std::string& name) { MAKE<M>(g, name); } };",
    ),
    "overriding": Feature(
        "std::unique_ptr<Base#> base = std::make_unique<Derived#>(); base->start(h);",
        ("n#",),
        """struct Base# {
  virtual ~Base#() = default;
  virtual std::string name() const { return "base#"; }
  void start(HANDLE g) { MAKE(g, name()); }
};
struct Derived# : public Base# { std::string name() const override { return "n#"; } };""",
    ),
    "factory": Feature(
        'build#("right")->start(h);',
        ("right#",),
        """struct Kind# { virtual ~Kind#() = default; virtual void start(HANDLE g) = 0; };
struct Left# : Kind# { void start(HANDLE g) override { MAKE(g, "left#"); } };
struct Right# : Kind# { void start(HANDLE g) override { MAKE(g, "right#"); } };
std::unique_ptr<Kind#> build#(const std::string& name) {
  if (name == "left") { return std::make_unique<Left#>(); }
  return std::make_unique<Right#>();
}""",
    ),
    "delegated": Feature(
        "Chain# chain(h);",
        ("n#/d",),
        """struct Chain# {
  explicit Chain#(HANDLE g) : Chain#(g, "n#") {}
  Chain#(HANDLE g, const std::string& name) : name_(name) { MAKE(g, name_ + "/d"); }
  std::string name_;
};""",
    ),
    "set before start": Feature(
        'Set# one, other; one.name("n#"); other.name("never#"); one.start(h);',
        ("n#",),
        """struct Set# {
  void name(const std::string& text) { text_ = text; }
  void start(HANDLE g) { MAKE(g, text_); }
  std::string text_;
};""",
    ),
    "handed back": Feature(
        "std::string got; fill#(got); MAKE(h, got);",
        ("n#",),
        'void fill#(std::string& out) { out = "n#"; }',
    ),
    "lambda": Feature(
        'auto make = [&](const std::string& name) { MAKE(h, name + "/l"); }; make("n#");',
        ("n#/l",),
    ),
    "namespaces": Feature(
        "right#::Thing# thing(h);",
        ("right#",),
        """namespace left# {
static const std::string kName = "left#";
struct Thing# { explicit Thing#(HANDLE g) { MAKE(g, kName); } };
}
namespace right# {
static const std::string kName = "right#";
struct Thing# { explicit Thing#(HANDLE g) { MAKE(g, kName); } };
}""",
    ),
    "early return": Feature(
        "ends#(h);",
        ("n#",),
        'void ends#(HANDLE g) { MAKE(g, "n#"); if (2 > 1) return; MAKE(g, "never#"); }',
    ),
    "branch, parameter": Feature(
        'if (READ<bool>("flag#", false)) { MAKE(h, "n#/yes"); } else { MAKE(h, "n#/no"); }', ("n#/yes", "n#/no")
    ),
    "branch, foreign": Feature(
        'if (foreign_flag()) { MAKE(h, "n#/yes"); } else { MAKE(h, "n#/no"); }', ("n#/yes", "n#/no")
    ),
    "branch, known": Feature(
        'int size = 3; if (size > 2) { MAKE(h, "n#/yes"); } else { MAKE(h, "n#/no"); }', ("n#/yes",)
    ),
    "choice of names": Feature(
        'std::string name; if (foreign_flag()) { name = "l#"; } else { name = "r#"; } MAKE(h, name + "/c");',
        ("l#/c", "r#/c"),
    ),
    "loop over a list": Feature(
        'const std::vector<std::string> all = {"a", "b", "c"}; for (const auto& one : all) { MAKE(h, "n#/" + one); }',
        ("n#/a", "n#/b", "n#/c"),
    ),
    "loop over numbers": Feature(
        'for (int k = 0; k < 3; ++k) { MAKE(h, "n#/" + std::to_string(k)); }', ("n#/0", "n#/1", "n#/2")
    ),
    "loop over pairs": Feature(
        'std::map<std::string, std::string> all = {{"a", "x"}, {"b", "y"}};'
        ' for (const auto& [key, value] : all) { MAKE(h, "n#/" + key + value); }',
        ("n#/ax", "n#/by"),
    ),
    "loop over structures": Feature(
        'std::vector<Entry#> all{{"a", "own"}, {"b"}};'
        ' for (const auto& one : all) { MAKE(h, "n#/" + one.name + one.end); }',
        ("n#/aown", "n#/busual"),
        'struct Entry# { std::string name; std::string end = "usual"; };',
    ),
    "loop that is left": Feature(
        'for (const std::string& one : {"a", "b", "c", "d"})'
        ' { if (one == "b") { continue; } MAKE(h, "n#/" + one); if (one == "c") { break; } }',
        ("n#/a", "n#/c"),
    ),
}


def composed(ros: int, uses: list[Use]) -> Program:
    """Return the program with these features, in this order."""
    declarations, statements, ends = [], [], set()
    for number, use in enumerate(uses):
        feature = FEATURES[use.feature]
        message = ("::msg::" if ros == 2 else "::").join(use.message)

        def filled(text: str, number: int = number, use: Use = use, message: str = message) -> str:
            created = _CREATED[ros, use.role]
            text = _MAKE.sub(lambda made: created.format(made["handle"], made["type"] or message, made["name"]), text)
            text = text.replace("HANDLE", _HANDLE[ros]).replace("MESSAGE", message).replace("READ", _READ[ros])
            return text.replace("#", str(number))

        lead = _LEAD[ros].format(use.namespace) if use.namespace else _LEAD_OF_ROOT[ros]
        declarations.append(filled(feature.declarations))
        statements.append(f"  {{ {lead} {filled(feature.statements)} }}")
        for name in map(filled, feature.names):
            whole = f"{use.namespace}/{name}" if use.namespace and name[0] not in "/~" else name
            ends.add((use.role, whole, "/".join(use.message)))
    source = _PROGRAM[ros].replace("DECLARATIONS", "\n".join(declarations)).replace("STATEMENTS", "\n".join(statements))
    return Program(source, frozenset(ends))


@st.composite
def programs(draw: st.DrawFn) -> Program:
    """Return a program of one to five features."""
    ros = draw(st.sampled_from([1, 2]))
    use = st.builds(
        Use,
        st.sampled_from([name for name, feature in FEATURES.items() if feature.ros in (0, ros)]),
        st.sampled_from(["", "arm", "left/arm"]),
        st.sampled_from(["publishes", "subscribes"]),
        st.sampled_from(MESSAGES),
    )
    return composed(ros, draw(st.lists(use, min_size=1, max_size=5)))
