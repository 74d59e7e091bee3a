from __future__ import annotations

import pytest

from kg.facts import Access, Role
from kg.symbolic.descriptions import Descriptions, merged, shipped

MAKER = """
ros = 2

[[class]]
name = "acme::Base"
is = "node"
node_name = 0

[[call]]
on = ["acme::Base"]
in = ["acme"]
name = ["make_publisher", "make_latched"]
arguments = [1, 2]
publishes = { name = 0, type = ["template"], qos = 1 }
returns = "acme::Publisher"
"""


def read(text: str) -> Descriptions:
    """Return the descriptions of one file."""
    found = Descriptions()
    found.read(text)
    return found


def test_calls_are_found_under_each_of_their_names() -> None:
    """A row describes every function that it names."""
    found = read(MAKER)
    assert set(found.calls) == {"make_publisher", "make_latched"}
    (described,) = found.calls["make_latched"]
    assert (described.on, described.scopes) == (("acme::Base",), ("acme",))
    assert (described.least, described.most, described.returns) == (1, 2, "acme::Publisher")


def test_effects_say_which_argument_is_what() -> None:
    """An effect has its role, the places of its arguments, and the version of ROS of its file."""
    (effect,) = read(MAKER).calls["make_publisher"][0].effects
    assert (effect.role, effect.access, effect.ros) == (Role.PUBLISHES, None, 2)
    assert (effect.name, effect.qos, effect.types) == (0, 1, ("template",))


def test_a_row_may_have_several_effects() -> None:
    """A list of effects of one kind, and effects of several kinds, are all read; a row may be of either ROS."""
    row = (
        'ros = 2\n[[call]]\nname = "f"\nros = 0\nreads = { name = 0, output = 1 }\n'
        'services = [{ fixed = "~/a", type = ["x/A"] }, { fixed = "~/b", type = ["x/B"] }]\n'
    )
    effects = read(row).calls["f"][0].effects
    assert {effect.fixed for effect in effects if effect.role is Role.SERVICES} == {"~/a", "~/b"}
    assert [effect.output for effect in effects if effect.access is Access.READ] == [1]
    assert {effect.ros for effect in effects} == {0}


@pytest.mark.parametrize(
    ("written", "known"),
    [
        ("acme::Base", True),
        ("Base", True),
        ("robot::acme::Base", True),
        ("other::Base", False),
        ("acme::Other", False),
        ("acme::Base::Inner", False),
    ],
)
def test_namespaces_must_agree(written: str, *, known: bool) -> None:
    """A class is the described one if the namespaces that both names have are the same."""
    found = read(MAKER).class_named(tuple(written.split("::")))
    assert (found is not None) is known


def test_no_name_is_no_class() -> None:
    """A type without a name has no description."""
    assert read(MAKER).class_named(()) is None


def test_descriptions_of_users_come_first() -> None:
    """A class or call described by a user has that meaning, and all others remain as shipped."""
    own_class = '[[class]]\nname = "ros::NodeHandle"\nis = "qos"\n'
    own_call = '[[call]]\non = ["ros::NodeHandle"]\nname = "advertise"\nmark = "own"\n'
    both = merged((own_class + own_call,))
    handle = both.class_named(("ros", "NodeHandle"))
    assert handle is not None
    assert handle.is_a == "qos"
    assert both.calls["advertise"][0].mark == "own"
    assert both.calls["advertise"][1:] == shipped().calls["advertise"]
    assert both.calls["subscribe"] == shipped().calls["subscribe"]


def test_merging_leaves_the_shipped_ones_alone() -> None:
    """A description by one user does not affect others."""
    before = {name: list(listed) for name, listed in shipped().calls.items()}
    merged((MAKER,))
    assert dict(shipped().calls) == before


def test_every_shipped_row_has_a_meaning() -> None:
    """Each shipped call has a context, and arguments within the allowed number."""
    for listed in shipped().calls.values():
        for call in listed:
            assert call.on or call.scopes, call.names
            assert call.least <= call.most, call.names
            for effect in call.effects:
                places = (effect.name, effect.qos, effect.default, effect.output)
                assert all(place is None or place < call.most for place in places), call.names


def test_classes_are_like_classes_that_are_described() -> None:
    """A class that has the calls of another names one that has a description."""
    described = shipped()
    for listed in described.classes.values():
        for one in listed:
            assert one.like is None or described.class_named(tuple(one.like.split("::"))) is not None, one.name
