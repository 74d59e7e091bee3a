from __future__ import annotations

import pytest

from kg.graph.packages import spdx


@pytest.mark.parametrize(
    ("name", "identifier"),
    [
        ("Apache License 2.0", "Apache-2.0"),
        ("apache-2.0", "Apache-2.0"),
        ("BSD-3-Clause", "BSD-3-Clause"),
        ("3-Clause BSD", "BSD-3-Clause"),
        ("GPLv3+", "GPL-3.0-or-later"),
        ("GPLv3", "GPL-3.0-only"),
        ("MIT License", "MIT"),
    ],
)
def test_usual_spellings_are_known(name: str, identifier: str) -> None:
    """Spellings of a licence lead to its SPDX IRI."""
    assert spdx(name) == f"https://spdx.org/licenses/{identifier}"


@pytest.mark.parametrize("name", ["BSD", "GPL", "LGPL", "TODO: License declaration", "Proprietary", ""])
def test_a_name_that_does_not_say_which_licence_is_not_guessed(name: str) -> None:
    """`BSD` may be any of several licences."""
    assert spdx(name) is None
