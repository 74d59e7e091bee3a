from __future__ import annotations

from typing import TYPE_CHECKING

import pytest
from extract.cpp.generated import FEATURES, MESSAGES, Use, composed, programs
from extract.cpp.packages import interfaces_of
from hypothesis import given, settings

if TYPE_CHECKING:
    from extract.cpp.generated import Program

ALONE = [(name, ros) for name, feature in FEATURES.items() for ros in (1, 2) if feature.ros in (0, ros)]


def found_in(program: Program) -> set[tuple[str, str | None, str | None]]:
    """Return role, name and type of each interface extracted from a program."""
    return {(item.role.value, item.name, item.type) for item in interfaces_of(program.source)}


@pytest.mark.parametrize(("feature", "ros"), ALONE)
def test_each_feature_alone(feature: str, ros: int) -> None:
    """A feature has its interfaces, below the namespace of the handle, and no others."""
    program = composed(ros, [Use("in place"), Use(feature, "left/arm", "subscribes", MESSAGES[2])])
    assert found_in(program) == program.ends


@settings(max_examples=60, deadline=None)
@given(programs())
def test_programs_have_the_interfaces_they_create(program: Program) -> None:
    """For any combination of features, exactly the interfaces created at run time are extracted."""
    assert found_in(program) == program.ends
