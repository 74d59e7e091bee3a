"""Driving: reading and executing a robot's capabilities without knowing its topics.

async with Driver(connection, capabilities) as driver:
    where = await driver.latest("sensingPose")                          # {"x": 0.3, "y": 1.2, "heading": 0.1}
    await driver.do("drivingAtVelocity", {"forward": 0.2}, seconds=2)   # then a zero command
    await driver.do("goingToPose", {"x": 3, "y": 1}, seconds=60)        # until it is there
"""

from __future__ import annotations

from kg.robot.driving.driver import Driver
from kg.robot.driving.routes import Outcome, Plan
from kg.robot.driving.watchdog import Watchdog
from kg.robot.driving.ways import find

__all__ = ["Driver", "Outcome", "Plan", "Watchdog", "find"]
