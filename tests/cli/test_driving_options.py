"""Options of `kg robot do` on the command line."""

from __future__ import annotations

import pytest

from kg.cli.commands.robot_driving import Doing
from kg.errors import UsageError


def test_an_argument_is_given_once() -> None:
    """A repeated parameter is rejected; the last value does not win."""
    options = {"keep": "1", "timeout": None, "way": None}
    with pytest.raises(UsageError, match="given twice"):
        Doing.of(["forward=0.1", "forward=0.2"], **options, dry_run=False, exclusive=False, json=False)
