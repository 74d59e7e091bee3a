"""A robot in a process of its own, over ROS 1 or DDS, that prints the velocities and goals it receives.

    python drivable.py ADDRESS

Without an address it runs a master of ROS 1. It prints its address first, then `speed X`, `goal`, `cancelled`, and
`settled` when its subscription stays open, and runs until its standard input is closed.
"""

from __future__ import annotations

import asyncio
import os
import subprocess
import sys
from contextlib import contextmanager, nullcontext
from pathlib import Path
from threading import Timer
from typing import TYPE_CHECKING, Final

from forks import start

from kg.robot.connecting import connect
from kg.robot.ros1 import Master
from kg.robot.ros2.ends import Ros2Subscription

if TYPE_CHECKING:
    from collections.abc import Iterator

    from forks import Forked

    from kg.robot.connection import Accepted, Value

__all__ = ["BLOCKABLE", "MODULES", "Drivable", "clean", "drivable"]

BLOCKABLE: Final = """
import signal
signal.pthread_sigmask(signal.SIG_BLOCK, [signal.SIGUSR2])
signal.signal(signal.SIGUSR1, lambda *_: signal.sigwait([signal.SIGUSR2]))
"""
"""Code run before a process that makes SIGUSR1 block its event loop until SIGUSR2 arrives."""
MODULES: Final = {
    1: ("kg.robot.driving.doing", "kg.robot.driving.watchdog", "kg.robot.programs.runner", "kg.robot.ros1"),
    2: ("kg.robot.driving.doing", "kg.robot.driving.watchdog", "kg.robot.programs.runner", "kg.robot.dds"),
}
"""Modules of robots of ROS 1 and 2, and of programs that drive them; they are imported before a fork."""
_GOALS: Final = {1: ("/move_base", "move_base_msgs/MoveBase"), 2: ("/navigate_to_pose", "nav2_msgs/NavigateToPose")}


class Drivable:
    """The robot: its address, and its output."""

    def __init__(self, process: Forked | subprocess.Popen[str]) -> None:
        self._process = process
        self.address = self._line()

    def _line(self) -> str:
        assert self._process.stdout is not None
        return self._process.stdout.readline().strip()

    def until(self, *wanted: str) -> None:
        """Return when one of these lines was printed; fail if the robot exits before."""
        while (line := self._line()) not in wanted:
            assert line, f"the robot never printed one of {wanted}"

    def stands_still(self) -> bool:
        """End the robot and return whether its last command was zero, and nothing drove it since `until`.

        A DDS reader opened while the controller was suspended may receive the cached message of its writer once.
        """
        rest = [line for line in self._process.communicate()[0].splitlines() if line.startswith("speed")]
        return rest[-1:] in ([], ["speed 0"]) and len([line for line in rest if line != "speed 0"]) <= 1


@contextmanager
def drivable(ros: int, seconds: float) -> Iterator[Drivable]:
    """Run a robot of ROS 1 or 2, for at most so many seconds."""
    pipe = subprocess.PIPE
    with nullcontext("") if ros == 1 else _dds() as address, start(
        *(__file__, *([address] if address else [])),
        streams=(pipe, pipe, None), environment=clean(), modules=MODULES[ros],
    ) as process:  # fmt: skip
        patience = Timer(seconds, process.kill)
        patience.start()
        try:
            yield Drivable(process)
        finally:
            patience.cancel()
            process.kill()


@contextmanager
def _dds() -> Iterator[str]:
    from robot.dds.domain import domain  # noqa: PLC0415 - needs an extra

    with domain() as number:
        yield f"dds://{number}?settle=1"


def clean() -> dict[str, str]:
    """Return the environment without settings of kg and ROS, and with the test modules importable."""
    kept = {name: value for name, value in os.environ.items() if not name.startswith(("KG_", "ROS_"))}
    return {**kept, "PYTHONPATH": str(Path(__file__).parents[2])}


async def _run(address: str) -> None:
    node = await connect(address, name="/robot")
    speeds = await node.subscribe("/cmd_vel", "geometry_msgs/Twist", queue=1000)
    goal = asyncio.Event()

    async def carry_out(accepted: Accepted) -> Value:
        goal.set()
        _print("goal")
        while not accepted.cancelled:  # noqa: ASYNC110 - nothing tells it
            await asyncio.sleep(0.02)
        _print("cancelled")
        return {}

    await node.serve_action(*_GOALS[node.ros], carry_out)
    _print(address)

    async def follow() -> None:
        async for one in speeds:
            _print(f"speed {one.value['linear']['x']:g}")

    async def settle() -> None:
        # A subscription of DDS is reopened for the first latched publisher, and misses messages in between.
        if isinstance(speeds, Ros2Subscription):
            while speeds._qos is None or speeds._qos.durability != "transient_local":  # noqa: ASYNC110 - nothing tells it
                await asyncio.sleep(0.02)
        _print("settled")

    tasks = [asyncio.ensure_future(follow()), asyncio.ensure_future(settle())]
    await asyncio.to_thread(sys.stdin.read)
    for task in tasks:
        task.cancel()
    await node.aclose()


async def _main() -> None:
    if sys.argv[1:]:
        await _run(sys.argv[1])
    else:
        async with Master() as master:
            await _run(master.address)


def _print(line: str) -> None:
    sys.stdout.write(f"{line}\n")
    sys.stdout.flush()


if __name__ == "__main__":
    asyncio.run(_main())
