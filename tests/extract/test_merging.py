from __future__ import annotations

from dataclasses import replace

from hypothesis import given
from hypothesis import strategies as st

from kg.extract.marks import Extracted, Mark
from kg.extract.package import canonical, merge, own_name
from kg.facts import Access, Interface, Location, NodeKind, NodeType, Parameter, Resolution, Role

SCAN = Interface(Role.SUBSCRIBES, "scan", "sensor_msgs/LaserScan", Resolution.LITERAL, Location("a.cpp", 3))
MAP = Interface(Role.PUBLISHES, "~/map", "nav_msgs/OccupancyGrid", Resolution.LITERAL, Location("a.cpp", 2))
RATE = Parameter("~/rate", "double", "1.0", Access.READ, Location("a.cpp", 5))
NODE = NodeType("slam", NodeKind.EXECUTABLE, "cpp", 1, Location("a.cpp", 1), executable="slam")


def test_a_node_read_twice_is_one_with_the_facts_of_both() -> None:
    """Two readings of one node become one node type with every fact, name and mark of them."""
    mark = Mark("tf.listener", Location("a.cpp", 4))
    first = Extracted(replace(NODE, interfaces=(SCAN,), sources=("a.cpp",)))
    second = Extracted(replace(NODE, interfaces=(SCAN, MAP), node_name="gmapping", parameters=(RATE,)), (mark,))
    (both,) = merge([first, second])
    assert both.node.interfaces == (SCAN, MAP)
    assert both.node.parameters == (RATE,)
    assert (both.node.node_name, both.marks) == ("gmapping", (mark,))


LOADED = replace(
    NODE,
    name="Slam",
    kind=NodeKind.NODELET,
    executable=None,
    plugin="slam/Slam",
    interfaces=(SCAN,),
    parameters=(RATE,),
)
STARTED = replace(NODE, node_name="gmapping", interfaces=(SCAN,), parameters=(RATE,))


def merged(*nodes: NodeType) -> list[tuple[str, str | None, str | None, tuple[str, ...]]]:
    """Return name, executable, class and aliases of merged nodes."""
    found = [one.node for one in merge([Extracted(node) for node in nodes])]
    return [(one.name, one.executable, one.plugin, one.aliases) for one in found]


def test_a_class_and_its_executables_are_one_node() -> None:
    """Their declarations are equal, whatever their calls; the first executable gives the name, others are aliases."""
    called = replace(STARTED, interfaces=(replace(SCAN, location=Location("main.cpp", 9), via=(SCAN.location,)),))
    other = replace(called, name="slam_mt", executable="slam_mt")
    assert merged(called, other, LOADED) == [("slam", "slam", "slam/Slam", ("slam_mt",))]
    (one,) = merge([Extracted(called), Extracted(LOADED)])
    assert (one.node.kind, one.node.node_name, len(one.node.interfaces)) == (NodeKind.NODELET, "gmapping", 1)


def test_a_class_registered_twice_is_one_node() -> None:
    """The same class is one node type, with the executable of one of its registrations."""
    assert merged(LOADED, replace(LOADED, name="slam", executable="slam")) == [("slam", "slam", "slam/Slam", ())]


def test_an_executable_that_differs_from_a_class_stays_apart() -> None:
    """More facts, another line, another name, no facts, or two matching classes: each is a separate node."""
    assert len(merged(replace(STARTED, interfaces=(SCAN, MAP)), LOADED)) == 2
    assert len(merged(replace(STARTED, interfaces=(replace(SCAN, location=MAP.location),)), LOADED)) == 2
    assert len(merged(STARTED, replace(LOADED, node_name="slam"))) == 2
    assert len(merged(NODE, replace(LOADED, interfaces=(), parameters=()))) == 2
    assert len(merged(STARTED, LOADED, replace(LOADED, name="Other", plugin="slam/Other"))) == 3
    assert len(merge([Extracted(STARTED, (Mark("tf.listener", SCAN.location),)), Extracted(LOADED)])) == 2


def test_names_left_open_are_resolved_under_the_nodes_own_name() -> None:
    """A private name is resolved below the name that the node gives itself, else below that of its type."""
    (plain,) = canonical([replace(NODE, interfaces=(SCAN, MAP))])
    (named,) = canonical([replace(NODE, interfaces=(MAP,), node_name="gmapping")])
    assert [i.resolved for i in plain.interfaces] == ["/slam/map", "/scan"]
    assert [i.resolved for i in named.interfaces] == ["/gmapping/map"]


def test_own_names_are_those_a_node_can_have() -> None:
    """A class or plugin has its last name, a script no suffix; a name that the code gives in part keeps its holes."""
    assert own_name(replace(NODE, name="nav::core::Planner")) == "Planner"
    assert own_name(replace(NODE, name="pkg/Planner", node_name="{}_planner")) == "{}_planner"
    assert own_name(replace(NODE, name="talker.py")) == "talker"


FACTS = st.lists(st.sampled_from([SCAN, MAP, replace(SCAN, name=None), replace(MAP, type=None)]), max_size=8)


@given(facts=FACTS, data=st.data())
def test_the_order_in_which_facts_were_found_does_not_show(facts: list[Interface], data: st.DataObject) -> None:
    """Merging gives the same node for every order of its facts, and no fact twice."""
    shuffled = data.draw(st.permutations(facts))
    (one,) = canonical([replace(NODE, interfaces=tuple(facts))])
    (other,) = canonical([replace(NODE, interfaces=tuple(shuffled))])
    assert one == other
    assert len(set(one.interfaces)) == len(one.interfaces) == len(set(facts))
