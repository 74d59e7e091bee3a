"""Our own master on unavailable ports."""

from __future__ import annotations

import asyncio

import pytest

from kg.errors import RobotError
from kg.robot.ros1 import Master


def test_a_port_that_is_taken() -> None:
    """A port in use is KG814, with the hint to use another one."""

    async def scene() -> None:
        async with Master() as master:
            port = int(master.address.rpartition(":")[2])
            with pytest.raises(RobotError) as refused:
                await Master(port=port).__aenter__()
            assert refused.value.code == "KG814"
            assert "another port" in (refused.value.hint or "")

    asyncio.run(scene())
