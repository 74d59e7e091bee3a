"""Tests of calling views by name."""

from __future__ import annotations

from typing import Any, get_type_hints

import pytest

from kg.errors import QueryError
from kg.settings import load
from kg.views.calls import _NAMES, CALLS


@pytest.mark.parametrize("name", CALLS)
def test_every_view_says_what_it_takes(name: str) -> None:
    """The annotations of each view can be evaluated at run time, and it has documentation."""
    function = CALLS[name].function
    assert get_type_hints(function, localns=_NAMES)
    assert function.__doc__


@pytest.mark.parametrize(
    ("name", "arguments"),
    [
        ("overview", {"what": "is this"}),
        ("rule", {}),
        ("rule", {"name": None}),
        ("rule", {"name": ["a"]}),
        ("rule", {"name": 1}),
        ("find", {"text": "a", "anything": []}),
        ("place", {"path": {}}),
        ("why", {"subject": "a", "predicate": "b", "object": 3.5}),
        ("cells", {"triples": [[1]]}),
        ("node", {"snapshot": "1"}),
        ("node", {"settings": "x", "self": "y"}),
    ],
)
def test_arguments_that_do_not_fit(name: str, arguments: dict[str, Any]) -> None:
    """An unknown or missing argument, or one of another type, is the caller's error."""
    nothing: Any = None
    with pytest.raises(QueryError) as caught:
        CALLS[name](nothing, load({}, environment={}), **arguments)
    assert caught.value.code == "KG505"
