from __future__ import annotations

from typing import TYPE_CHECKING

import pytest
from hypothesis import given
from hypothesis import strategies as st
from pyoxigraph import NamedNode

from kg.errors import UsageError
from kg.graph.iris import Iris, Thing, fragment

if TYPE_CHECKING:
    from collections.abc import Callable

IRIS = Iris()
TEXT = st.text(st.characters(codec=None), max_size=12)
LIKELY = st.sampled_from(["", "/", "-", ".", "..", "a/-/b", "%2F", "~/x", "@2", "#", "a b", "node", "é", "\udcff"])
PART = TEXT | LIKELY
MAKERS: list[tuple[str, int, Callable[..., str]]] = [
    ("repository", 1, IRIS.repository),
    ("package", 2, IRIS.package),
    ("node", 3, IRIS.node),
    ("executable", 3, IRIS.executable),
    ("definition", 4, IRIS.definition),
    ("file", 2, IRIS.file),
    ("build", 2, IRIS.build),
    ("package-name", 1, IRIS.package_name),
    ("person", 2, IRIS.person),
    ("qos", 4, IRIS.qos),
    ("qos", 7, IRIS.qos),
    ("software", 2, IRIS.software),
    ("message", 1, lambda name: IRIS.interface_type("message", name)),
    ("service-type", 1, lambda name: IRIS.interface_type("service-type", name)),
    ("action-type", 1, lambda name: IRIS.interface_type("action-type", name)),
    ("topic", 1, lambda name: IRIS.channel("topic", f"/{name}")),
    ("service", 1, lambda name: IRIS.channel("service", f"/{name}")),
    ("action", 1, lambda name: IRIS.channel("action", f"/{name}")),
]


@pytest.mark.parametrize(("kind", "arity", "make"), MAKERS, ids=[f"{maker[0]}-{maker[1]}" for maker in MAKERS])
@given(data=st.data())
def test_any_text_makes_a_valid_iri_that_gives_the_text_back(
    kind: str, arity: int, make: Callable[..., str], data: st.DataObject
) -> None:
    """For any parts, the IRI is valid, belongs to its kind, and can be split again: it is injective."""
    parts = data.draw(st.tuples(*[PART] * arity))
    iri = make(*parts)
    assert NamedNode(iri).value == iri
    assert iri.isascii()
    expected = (f"/{parts[0]}",) if kind in {"topic", "service", "action"} else parts
    assert IRIS.parse(iri) == Thing(kind, expected)


@given(
    one=st.tuples(PART, st.none() | PART, st.integers(1, 3)),
    other=st.tuples(PART, st.none() | PART, st.integers(1, 3)),
)
def test_fragments_tell_parts_of_a_thing_apart(
    one: tuple[str, str | None, int], other: tuple[str, str | None, int]
) -> None:
    """Parts differ by owner, name and count; an unknown name differs from every name."""
    iris = [fragment(IRIS.package_name(owner), "publisher", name, count) for owner, name, count in (one, other)]
    assert all(NamedNode(iri).value == iri for iri in iris)
    assert (iris[0] == iris[1]) == (one == other)


def test_parts_of_parts() -> None:
    """A part of a part has a valid IRI, too: one `#`, with the rest appended to the owner's."""
    owner = fragment(IRIS.node("h/o/r", "p", "n"), "again", "")
    part = fragment(owner, "publisher", "/scan")
    assert NamedNode(part).value == part
    assert part.startswith(owner)
    assert part.count("#") == 1


@given(owner=st.tuples(PART, PART, PART), name=PART)
def test_a_part_is_never_a_thing_of_its_own(owner: tuple[str, str, str], name: str) -> None:
    """The IRI of an interface is never that of another node."""
    assert IRIS.parse(fragment(IRIS.node(*owner), "publisher", name)) is None


def test_iris_are_readable() -> None:
    """Names that need no encoding are unchanged in the IRI."""
    assert IRIS.node("github.com/husky/husky", "husky_base", "husky_node") == (
        "https://w3id.org/rnkg/node/github.com/husky/husky/husky_base/husky_node"
    )
    assert IRIS.channel("topic", "/camera/image_raw") == "https://w3id.org/rnkg/topic/camera/image_raw"
    assert IRIS.file("local/ws", "a/b.cpp") == "https://w3id.org/rnkg/file/local/ws/-/a/b.cpp"
    assert fragment("n", "publisher", "~/costmap") == "n#publisher/~/costmap"
    assert fragment("n", "publisher", "~/costmap", 2) == "n#publisher/~/costmap@2"


@pytest.mark.parametrize(
    "iri",
    [
        "https://other.org/topic/x",
        "https://w3id.org/rnkg/",
        "https://w3id.org/rnkg/cat/x",
        "https://w3id.org/rnkg/file/local/ws/a.cpp",
        "https://w3id.org/rnkg/node/n",
        "https://w3id.org/rnkg/package-name/a/b",
    ],
)
def test_what_is_no_iri_of_ours_is_nothing(iri: str) -> None:
    """IRIs of other bases, of unknown kinds, and with a wrong number of parts are not parsed."""
    assert IRIS.parse(iri) is None


@pytest.mark.parametrize("base", ["", "rnkg/", "https://w3id.org/rnkg", "https://x.org/#", "https://x.org/a b/", "a:/"])
def test_a_base_that_cannot_be_one_is_refused(base: str) -> None:
    """The base is absolute, ends in a slash and is a valid IRI."""
    with pytest.raises(UsageError, match="base of IRIs") as caught:
        Iris(base)
    assert caught.value.code == "KG002"


def test_another_base_is_used_everywhere() -> None:
    """IRIs use the requested base and are parsed with it."""
    iris = Iris("http://localhost:8000/")
    assert iris.repository("local/ws") == "http://localhost:8000/repository/local/ws"
    assert iris.parse("http://localhost:8000/package-name/roscpp") == Thing("package-name", ("roscpp",))
