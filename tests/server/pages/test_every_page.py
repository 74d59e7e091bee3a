"""Requirements for every page."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest
from browsing import axe
from listing import PAGES, examine

if TYPE_CHECKING:
    from browsing import Chromium
    from listing import Shown

_MISSING = {"node, misspelt", "rule, missing", "rules, no such family", "address, missing"}
_REFUSED = {"search, wrong filter": 400} | dict.fromkeys(_MISSING, 404)
_ANY_COLUMNS = {"query, rows"}
_WITHOUT_TWIN = {"search, empty", "login"} | _MISSING


@pytest.mark.parametrize("name", PAGES)
def test_meets_every_requirement(browser: Chromium, site: str, things: Shown, name: str) -> None:
    """A page meets every requirement, examined in one visit.

    It has no error in the console, violates no policy, and sends no request to another host (C27, C28). Axe finds no
    violation, in light, and in dark at the width of a phone. The footer links to the same content as JSON. Tab reaches
    every usable element, and each shows its focus. Tables show all columns on a small laptop. No content makes the page
    wider than a phone.
    """
    found = browser.run(examine(browser, site + PAGES[name].format(**things)))
    expected = _REFUSED.get(name, 200)
    assert found.status == expected
    assert {
        "troubles": [one for one in found.troubles if not (expected != 200 and f"status of {expected}" in one)],
        "violations in light": found.light,
        "violations in dark on a phone": found.dark,
        "unreachable by Tab": found.missed,
        "without a visible focus": found.ringless,
        "cut off on a small laptop": [] if name in _ANY_COLUMNS else found.cut,
    } == {
        "troubles": [],
        "violations in light": [],
        "violations in dark on a phone": [],
        "unreachable by Tab": [],
        "without a visible focus": [],
        "cut off on a small laptop": [],
    }
    assert name in _WITHOUT_TWIN or found.twins == 1
    assert found.width <= 390
    if not axe():
        pytest.skip("all but accessibility was tested: axe-core is not installed: run `python frontend/build.py`")
