"""A small in-memory robot for tests of the robot page: `rover://NAME`, created on first use.

A test names `kg.robot.connecting.SCHEMES["rover"] = "rover"`, in its own process or in that of a server.
"""

from __future__ import annotations

import asyncio
import math
from typing import TYPE_CHECKING, Any, Final
from urllib.parse import urlsplit

from repository import ROOT

from kg.robot.memory import Bus

if TYPE_CHECKING:
    from kg.robot.connection import Connection
    from kg.robot.messages import Types

__all__ = ["PICTURE", "PLACES", "PREPARED", "Rover", "connect"]

PREPARED: Final = f"""
sys.path.insert(0, {str(ROOT / "tests")!r})
from kg.robot.connecting import SCHEMES
SCHEMES["rover"] = "rover"
"""
"""Code that a server process runs first to register the addresses of rovers."""

PICTURE: Final = (
    '<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 9 9" data-left="0" data-top="9" data-scale="1">'
    "<style>rect{fill:#2563eb}</style>"
    '<rect width="9" height="9"/><script>top.owned = true</script></svg>'
)
"""The rover's picture of itself, with content that must never be executed."""
PLACES: Final = '"the desk" = { x = 2.5, y = 1, heading = 90 }'
"""The places reported by the rover, in the format of a file of places."""
_STEP: Final = 0.02


class Rover:
    """A base that takes velocities, reaches goals at once, and reports its position.

    `commands` are the velocities received, as (forward, turn).
    """

    known: Final[dict[str, Rover]] = {}

    def __init__(self, name: str) -> None:
        self.bus = Bus(name, ros=1)
        self.commands: list[tuple[float, float]] = []
        self.place = [0.0, 0.0, 0.0]
        self._tasks: list[asyncio.Task[None]] = []

    async def start(self) -> None:
        """Start its nodes."""
        base, simulator = self.bus.join("/base"), self.bus.join("/simulator")
        subscription = await base.subscribe("/cmd_vel", "geometry_msgs/Twist", queue=100)
        goals = await base.subscribe("/move_base_simple/goal", "geometry_msgs/PoseStamped", queue=10)
        places = await simulator.advertise("/simulator/places", "std_msgs/String", latch=True)
        await places.publish({"data": PLACES})
        odometry = await base.advertise("/odom", "nav_msgs/Odometry")
        picture = await simulator.advertise("/simulator/view", "std_msgs/String", latch=True)
        await picture.publish({"data": PICTURE})

        async def listen() -> None:
            async for received in subscription:
                self.commands.append((received.value["linear"]["x"], received.value["angular"]["z"]))

        async def jump() -> None:
            async for received in goals:
                position = received.value["pose"]["position"]
                self.place = [position["x"], position["y"], 0.0]

        async def move() -> None:
            while True:
                forward, turn = self.commands[-1] if self.commands else (0.0, 0.0)
                x, y, heading = self.place
                self.place = [
                    x + forward * math.cos(heading) * _STEP,
                    y + forward * math.sin(heading) * _STEP,
                    heading + turn * _STEP,
                ]
                await odometry.publish(self._odometry(forward, turn))
                await asyncio.sleep(_STEP)

        self._tasks = [asyncio.ensure_future(one) for one in (listen(), jump(), move())]

    def _odometry(self, forward: float, turn: float) -> dict[str, Any]:
        x, y, heading = self.place
        turned = {"z": math.sin(heading / 2), "w": math.cos(heading / 2)}
        return {
            "header": {"frame_id": "odom"},
            "pose": {"pose": {"position": {"x": x, "y": y}, "orientation": turned}},
            "twist": {"twist": {"linear": {"x": forward}, "angular": {"z": turn}}},
        }

    async def stop(self) -> None:
        """Stop its nodes."""
        for task in self._tasks:
            task.cancel()
        await asyncio.gather(*self._tasks, return_exceptions=True)
        self.bus.close()
        self.known.pop(self.bus.name, None)


async def connect(address: str, name: str, types: Types | None = None) -> Connection:
    """Join the system of a rover as a node."""
    known = urlsplit(address).netloc
    if known not in Rover.known:
        Rover.known[known] = Rover(known)
        await Rover.known[known].start()
    return Rover.known[known].bus.join(name, types)
