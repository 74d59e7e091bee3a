"""Requirements for every page."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest
from browsing import axe
from listing import PAGES

if TYPE_CHECKING:
    from collections.abc import Callable

    from listing import Examined

    Examine = Callable[[str], Examined]

_MISSING = {"node, misspelt", "rule, missing", "rules, no such family", "address, missing"}
_REFUSED = {"search, wrong filter": 400} | dict.fromkeys(_MISSING, 404)
_WITHOUT_TWIN = {"search, empty", "login"} | _MISSING
_EVERY = pytest.mark.parametrize("name", PAGES)


@_EVERY
def test_says_nothing_wrong(examined: Examine, name: str) -> None:
    """No page has an error in the console, violates its policy, or sends requests to another host (C27, C28)."""
    found = examined(name)
    expected = _REFUSED.get(name, 200)
    assert found.status == expected
    assert [one for one in found.troubles if not (expected != 200 and f"status of {expected}" in one)] == []


@_EVERY
@pytest.mark.skipif(not axe(), reason="axe-core is not installed: run `python frontend/build.py`")
def test_is_accessible(examined: Examine, name: str) -> None:
    """Axe finds no violation on any page, in light, and in dark at the width of a phone."""
    found = examined(name)
    assert (found.light, found.dark) == ([], [])


@pytest.mark.parametrize("name", sorted(PAGES.keys() - _WITHOUT_TWIN))
def test_has_a_twin(examined: Examine, name: str) -> None:
    """The footer links to the same content as JSON."""
    assert examined(name).twins == 1


@_EVERY
def test_can_be_walked_by_keyboard(examined: Examine, name: str) -> None:
    """Tab reaches every usable element, and each shows its focus."""
    found = examined(name)
    assert (found.missed, found.ringless) == ([], [])


@_EVERY
def test_fits_a_phone(examined: Examine, name: str) -> None:
    """No content makes a page wider than a phone."""
    assert examined(name).width <= 390
