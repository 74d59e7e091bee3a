"""An impact as lines for people."""

from __future__ import annotations

from kg.facts import Location
from kg.impact.model import Area, Effect, Grade, Impact, Kind, Subject
from kg.impact.writing import impact_lines

LINE = Location("config/nav.yaml", 22)


def effect(node: str, launch: str, area: Area = Area.PARAMETERS) -> Effect:
    """Return what one line of a file means for a node that a launch file starts."""
    what = f"odom_frame of {node} holds the name of the topic"
    return Effect(Grade.MAY, area, what, "how it is used is not known", LINE, "robots", (launch,))


def lines(*effects: Effect) -> list[str]:
    """Return the lines of the effects, without the subject."""
    return impact_lines(Impact(Subject(Kind.TOPIC, "/odom"), (), effects))[3:]


def test_a_line_of_a_parameter_file_is_written_once_for_all_nodes_that_it_sets() -> None:
    """A parameter file that several launch files give to several nodes is one entry."""
    assert lines(effect("/amcl", "one"), effect("/left/amcl", "two"), effect("/right/amcl", "two")) == [
        "parameter files",
        "  may     odom_frame of /amcl holds the name of the topic  config/nav.yaml:22",
        "          how it is used is not known; the same for 2 more nodes; in one, two",
    ]


def test_each_node_that_is_started_has_its_own_entry() -> None:
    """Nodes of one line of code lose different others."""
    written = lines(effect("/left", "one", Area.SYSTEMS), effect("/right", "one", Area.SYSTEMS))
    assert sum(one.startswith("  may") for one in written) == 2
