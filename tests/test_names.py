from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from kg.names import is_for_node

PARTS = st.lists(st.sampled_from(["a", "b", "ab"]), min_size=1, max_size=4)
KEYS = st.lists(st.sampled_from(["a", "b", "ab", "*", "**"]), min_size=1, max_size=4)


def naive(key: list[str], name: list[str]) -> bool:
    """Match part by part, with all ways in which `**` can be read."""
    if not key:
        return not name
    if key[0] == "**":
        return any(naive(key[1:], name[taken:]) for taken in range(len(name) + 1))
    return bool(name) and key[0] in ("*", name[0]) and naive(key[1:], name[1:])


@given(KEYS, PARTS)
def test_wildcards_stand_for_parts_of_names(key: list[str], name: list[str]) -> None:
    """`*` is one part and `**` any number of them, wherever they stand."""
    assert is_for_node("/" + "/".join(key), "/" + "/".join(name)) is naive(key, name)


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
    """A name with an unknown part is fitted by what it may turn out to be."""
    assert is_for_node(key, full) is expected
