"""A robot behind a bridge, in a process of its own, that prints its address and then the velocities that it gets.

    python bridged.py rosbridge|foxglove

It runs until its standard input ends.
"""

from __future__ import annotations

import sys
from importlib import import_module
from threading import Thread
from typing import Any

TOPIC, KIND = "/cmd_vel", "geometry_msgs/Twist"


class Printed(list[tuple[str, Any]]):
    """Messages that come from clients: each velocity is printed."""

    def append(self, message: tuple[str, Any]) -> None:
        """Print a velocity."""
        topic, value = message
        if topic == TOPIC:
            print(f"speed {value['linear']['x']:g}", flush=True)


def main() -> None:
    """Run the robot, of ROS 1 behind rosbridge and of ROS 2 behind Foxglove."""
    bridge = sys.argv[1]
    with import_module(f"robot.ws.{bridge}_peer").peer(1 if bridge == "rosbridge" else 2) as peer:
        peer.came = Printed()
        if bridge == "rosbridge":
            peer.node("/base", {}, {TOPIC: KIND})
        else:
            peer.channel(TOPIC, KIND)
            peer.graph({}, {TOPIC: ["/base"]})
        print(peer.address, flush=True)
        waiting = Thread(target=sys.stdin.read)
        waiting.start()
        waiting.join()


if __name__ == "__main__":
    main()
