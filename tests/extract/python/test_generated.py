from __future__ import annotations

from pathlib import Path
from tempfile import TemporaryDirectory
from typing import TYPE_CHECKING

import pytest
from extract.python.generated import FEATURES, MESSAGES, Use, composed, programs
from extract.python.programs import nodes_of
from hypothesis import given, settings

if TYPE_CHECKING:
    from extract.python.generated import Program

ALONE = [(name, ros) for name, feature in FEATURES.items() for ros in (1, 2) if feature.ros in (0, ros)]


def found_in(program: Program) -> set[tuple[str, str | None, str | None]]:
    """Return role, name and type of each interface extracted from a program."""
    with TemporaryDirectory() as root:
        found = nodes_of(Path(root), {"main.py": program.source})
    return {(i.role.value, i.name, i.type) for one in found for i in one.node.interfaces if not i.implicit}


@pytest.mark.parametrize(("feature", "ros"), ALONE)
def test_each_feature_alone(feature: str, ros: int) -> None:
    """A feature has its interfaces and no others."""
    program = composed(ros, [Use("in place"), Use(feature, "subscribes", MESSAGES[2])])
    assert found_in(program) == program.ends


@settings(max_examples=60, deadline=None)
@given(programs())
def test_programs_have_the_interfaces_they_create(program: Program) -> None:
    """For any combination of features, exactly the interfaces created at run time are extracted."""
    assert found_in(program) == program.ends
