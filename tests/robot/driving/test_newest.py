"""Subscriptions, including those to unresponsive publishers."""

from __future__ import annotations

import asyncio
from typing import TYPE_CHECKING

import pytest
from patience import patient
from robot.driving.rover import rover

from kg.errors import RobotError

if TYPE_CHECKING:
    from kg.robot.connection import Subscription


def test_closing_gives_up_subscribing() -> None:
    """A driver closes despite a hanging subscription, and notifies its waiters."""

    async def scene() -> None:
        async with rover() as robot:
            begun = asyncio.Event()

            async def hang(*_: object, **__: object) -> Subscription:
                begun.set()
                await asyncio.Event().wait()
                raise AssertionError

            with pytest.MonkeyPatch.context() as patch:
                patch.setattr(robot.driver.connection, "subscribe", hang)
                waiting = asyncio.ensure_future(robot.driver.latest("laserScanning", seconds=3600))
                await asyncio.wait_for(begun.wait(), patient(10))
                await asyncio.wait_for(robot.driver.__aexit__(None, None, None), patient(10))
                with pytest.raises(RobotError) as ended:
                    await asyncio.wait_for(waiting, patient(10))
                assert ended.value.code == "KG803"

    asyncio.run(scene())
