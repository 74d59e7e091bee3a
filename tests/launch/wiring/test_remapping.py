"""Remapping agrees with the rules of the client libraries, which are written out here name by name."""

from __future__ import annotations

from hypothesis import example, given
from hypothesis import strategies as st

from kg.facts import Location, Remap, Role
from kg.launch.wiring.place import Place
from kg.launch.wiring.remapping import Remapping, rules_of

_PART = st.sampled_from(["a", "b", "scan", "n"])
_BODY = st.lists(_PART, min_size=1, max_size=3).map("/".join)
_NAME = st.builds(str.__add__, st.sampled_from(["", "/", "~/"]), _BODY)
_NAMESPACE = st.lists(_PART, max_size=2).map(lambda parts: "/" + "/".join(parts))
_PAIRS = st.lists(st.tuples(_NAME, _NAME), max_size=6)
_ODD = st.text(alphabet="ab/~{}: _.-é\n", max_size=12)


def absolute(name: str, namespace: str, node: str) -> str:
    """Expand a name like `rcl_expand_topic_name` and `ros::names::resolve`."""
    if name.startswith("/"):
        return name
    if name.startswith("~/"):
        return f"{namespace.rstrip('/')}/{node}/{name[2:]}"
    return f"{namespace.rstrip('/')}/{name}"


def remaps(pairs: list[tuple[str, str]]) -> list[Remap]:
    """Return remappings, each on a line of its own."""
    return [Remap(source, target, Location("x.launch", line)) for line, (source, target) in enumerate(pairs, 1)]


def renamed(name: str, pairs: list[tuple[str, str]], namespace: str, ros: int) -> str:
    """Return a name in the code of node `n` after the rules."""
    place = Place(namespace, "n")
    remapping = Remapping(rules_of(remaps(pairs), place, ros), ros)
    return remapping.apply(place.resolve(name), Role.PUBLISHES)[0]


@given(_NAME, _PAIRS, _NAMESPACE, st.sampled_from([1, 2]))
def test_the_first_rule_whose_left_side_is_the_absolute_name_counts(
    name: str, pairs: list[tuple[str, str]], namespace: str, ros: int
) -> None:
    """Both sides of rules are resolved for the node; the result of a rule is final."""
    wanted = absolute(name, namespace, "n")
    fitting = [target for source, target in pairs if absolute(source, namespace, "n") == wanted]
    expected = absolute(fitting[0], namespace, "n") if fitting else wanted
    assert renamed(name, pairs, namespace, ros) == expected


_ABSOLUTE = st.lists(st.sampled_from(["cam", "camera", "x"]), min_size=1, max_size=3).map(lambda p: "/" + "/".join(p))


@given(_ABSOLUTE, _ABSOLUTE, _ABSOLUTE)
@example("/camera/x", "/cam", "/left")
@example("/cam/cam/cam", "/cam/cam", "/cam")
def test_a_rule_for_a_handle_moves_the_names_below_it_alone(name: str, handle: str, target: str) -> None:
    """A name is below a handle's namespace by whole parts: `/cam:=/left` moves `/cam/x`, not `/camera/x`.

    roscpp remaps the namespace when the handle is made, and the name that results once more.
    """
    remapping = Remapping(rules_of(remaps([(handle, target)]), Place("/", "n"), 1), 1)
    parts, above = name.split("/"), handle.split("/")
    moved = "/".join([target, *parts[len(above) :]]) if parts[: len(above)] == above else name
    assert remapping.apply(name, Role.PUBLISHES, handle)[0] == (target if moved == handle else moved)


@given(_NAME, _PAIRS, _NAMESPACE, st.sampled_from(["rostopic://", "rosservice://", "n:", "other:", "n:rostopic://"]))
def test_rules_of_ros2_can_be_for_some_names_and_nodes_alone(
    name: str, pairs: list[tuple[str, str]], namespace: str, front: str
) -> None:
    """A rule for services or another node does not affect topics; one for topics or this node does."""
    limited = [(front + source, target) for source, target in pairs]
    counts = front in {"rostopic://", "n:", "n:rostopic://"}
    plain = renamed(name, pairs if counts else [], namespace, 2)
    assert renamed(name, limited, namespace, 2) == plain


@given(_ODD, st.lists(st.tuples(_ODD, _ODD), max_size=4), _ODD, st.sampled_from([1, 2]), st.sampled_from(list(Role)))
def test_odd_names_are_no_reason_to_fail(
    name: str, pairs: list[tuple[str, str]], namespace: str, ros: int, role: Role
) -> None:
    """Any text in a launch file gives an absolute name."""
    place = Place(namespace, "n")
    remapping = Remapping(rules_of(remaps(pairs), place, ros), ros)
    assert remapping.apply(place.resolve(name), role)[0].startswith("/")


@given(_NAME, _NAMESPACE)
def test_a_rule_that_changed_a_name_is_marked_as_used(name: str, namespace: str) -> None:
    """Only the applied rule is marked."""
    place = Place(namespace, "n")
    rules = remaps([("never/fits/this", "x"), (name, "target"), (name, "other")])
    remapping = Remapping(rules_of(rules, place, 1), 1)
    assert remapping.apply(place.resolve(name), Role.SUBSCRIBES)[1] == rules[1]
    assert remapping.used == {rules[1]}
