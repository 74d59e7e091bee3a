from __future__ import annotations

import re

import pytest
from hypothesis import example, given
from hypothesis import strategies as st

from kg.names import is_for_node, join, normalise, resolve

NAMES = st.text("ab/~", max_size=8)
FULL = st.text("ab/", max_size=8).map("/".__add__)
KEYS = st.lists(st.sampled_from(["/", "a", "b", "/*", "/**"]), min_size=1, max_size=5).map("".join)


@pytest.mark.parametrize(
    ("name", "expected"),
    [("scan", "scan"), ("//a//b/", "/a/b"), ("a/b/", "a/b"), ("/", "/"), ("", ""), ("~", "~"), ("~x", "~/x"),
     ("~/x/", "~/x"), ("~//x", "~/x"), ("~/", "~")],
)  # fmt: skip
def test_a_name_is_written_in_one_way(name: str, expected: str) -> None:
    """Normal form: single slashes, no trailing slash, and `~/` before private names, as in ROS 1 and ROS 2."""
    assert normalise(name) == expected


@given(NAMES)
def test_what_is_written_so_stays_so(name: str) -> None:
    """Normalising twice equals normalising once."""
    assert normalise(normalise(name)) == normalise(name)


@pytest.mark.parametrize(
    ("namespace", "name", "expected"),
    [("", "scan", "scan"), ("ns", "scan", "ns/scan"), ("/ns/", "scan", "/ns/scan"), ("~", "scan", "~/scan"),
     ("~/front", "scan", "~/front/scan"), ("/ns", "/scan", "/scan"), ("/ns", "~scan", "~/scan"), ("/ns/", "", "/ns")],
)  # fmt: skip
def test_a_name_below_the_namespace_of_a_handle(namespace: str, name: str, expected: str) -> None:
    """A relative name is below the namespace of the handle; absolute and private names have their own root."""
    assert join(namespace, name) == expected


@pytest.mark.parametrize(
    ("name", "expected"),
    [("scan", "/ns/scan"), ("front/scan", "/ns/front/scan"), ("/scan", "/scan"), ("~scan", "/ns/laser/scan"),
     ("~/scan", "/ns/laser/scan"), ("~", "/ns/laser")],
)  # fmt: skip
def test_a_name_is_resolved_for_a_node(name: str, expected: str) -> None:
    """Relative names are below the namespace, private ones below the node (wiki.ros.org/Names, section 1.2)."""
    assert resolve(name, "laser", "/ns") == expected
    assert resolve(name, "laser") == expected.replace("/ns", "", 1)


@given(KEYS, FULL)
@example("/*b", "/b")
@example("/**b", "/b")
@example("/a/*", "/a/")
@example("/**", "/a//b")
def test_a_wildcard_matches_parts_that_are_not_empty(key: str, full: str) -> None:
    """`/*` matches one part and `/**` any number of parts, as in the regular expression of rclcpp."""
    absolute = "/" + key.strip("/")
    pattern = absolute.replace("/**", r"(/\w+)*").replace("/*", r"(/\w+)")
    assert is_for_node(key, full) is bool(re.fullmatch(pattern, full))


@pytest.mark.parametrize(
    ("key", "full", "expected"),
    [
        ("n", "/n", True),
        ("/n", "/ns/n", False),
        ("/**", "/ns/n", True),
        ("/*", "/ns/n", False),
        ("/ns/*", "/ns/n", True),
        ("/ns/n", "/{}/n", None),
        ("/ns/m", "/{}/n", False),
        ("/**", "/{}/n", True),
        ("/ns/*", "/{}/n", None),
    ],
)
def test_names_that_are_not_known(key: str, full: str, expected: bool | None) -> None:  # noqa: FBT001  (a case)
    """A name with an unknown part matches its possible values."""
    assert is_for_node(key, full) is expected
