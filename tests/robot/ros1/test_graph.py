"""The polling rate of a master."""

from __future__ import annotations

from itertools import pairwise

from kg.robot.ros1.graph import pause


def test_a_master_that_answers_quickly_is_asked_more_often() -> None:
    """At most twenty times a second and for a tenth of its time; a slow master is polled after a fifth of a second."""
    assert pause(0.001) == 0.05
    assert pause(0.01) == 9 * 0.01
    assert pause(0.5) == 0.2
    waits = [pause(took / 1000) for took in range(100)]
    assert all(sooner <= later for sooner, later in pairwise(waits))
