from __future__ import annotations

import pytest

from kg.syntax.names import is_absolute, resolve

BASE = "http://a/b/c/d;p?q"


@pytest.mark.parametrize(
    ("reference", "expected"),
    [
        ("g:h", "g:h"),
        ("g", "http://a/b/c/g"),
        ("./g", "http://a/b/c/g"),
        ("g/", "http://a/b/c/g/"),
        ("/g", "http://a/g"),
        ("//g", "http://g"),
        ("?y", "http://a/b/c/d;p?y"),
        ("g?y#s", "http://a/b/c/g?y#s"),
        ("#s", "http://a/b/c/d;p?q#s"),
        (";x", "http://a/b/c/;x"),
        ("", "http://a/b/c/d;p?q"),
        (".", "http://a/b/c/"),
        ("..", "http://a/b/"),
        ("../g", "http://a/b/g"),
        ("../..", "http://a/"),
        ("../../../g", "http://a/g"),
        ("/./g", "http://a/g"),
        ("g.", "http://a/b/c/g."),
        ("..g", "http://a/b/c/..g"),
        ("./g/.", "http://a/b/c/g/"),
        ("g;x=1/../y", "http://a/b/c/y"),
        ("g#s/../x", "http://a/b/c/g#s/../x"),
    ],
)
def test_references_are_resolved_as_the_standard_says(reference: str, expected: str) -> None:
    """The examples of RFC 3986, section 5.4, give the stated results."""
    assert resolve(BASE, reference) == expected


def test_a_base_without_a_path_is_a_root() -> None:
    """A name relative to a bare host is below its root."""
    assert resolve("http://a", "g") == "http://a/g"


def test_an_absolute_iri_stays_as_it_is_written() -> None:
    """A reference with a scheme is unchanged, including dots in its path."""
    assert resolve(BASE, "http://x/a/../b") == "http://x/a/../b"
    assert is_absolute("urn:x")
    assert not is_absolute("1a:b")
