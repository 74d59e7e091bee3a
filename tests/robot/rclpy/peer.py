"""A robot as users of ROS 2 write one: a node of rclpy in a process of its own, independent of kg.

    python peer.py

It publishes `/odom` (best effort) and `/words` (transient local), prints the velocities it receives, serves `/enable`
and executes `/count`. For each line of its standard input, the name of a node, it prints the names of the parameters
of that node, whether it could set `use_sim_time`, and the next line of the log of kg. It ends with its input.
"""

from __future__ import annotations

import sys
import time
from queue import Queue
from threading import Thread
from typing import Any

import rclpy
from geometry_msgs.msg import Twist
from nav_msgs.msg import Odometry
from rcl_interfaces.msg import Log
from rclpy.action import ActionServer, CancelResponse
from rclpy.executors import MultiThreadedExecutor
from rclpy.parameter import Parameter
from rclpy.parameter_client import AsyncParameterClient
from rclpy.qos import DurabilityPolicy, QoSProfile, qos_profile_sensor_data
from std_msgs.msg import String
from std_srvs.srv import SetBool
from test_msgs.action import Fibonacci


def say(line: str) -> None:
    """Print a line and flush it."""
    sys.stdout.write(f"{line}\n")
    sys.stdout.flush()


def enable(request: Any, response: Any) -> Any:
    """Answer the request."""
    response.success, response.message = request.data, "on" if request.data else "off"
    return response


def count(handle: Any) -> Any:
    """Send feedback until the order is reached, or the goal is cancelled; a negative order aborts."""
    sequence = [0, 1]
    for _ in range(handle.request.order):
        if handle.is_cancel_requested:
            handle.canceled()
            return Fibonacci.Result(sequence=sequence)
        sequence.append(sequence[-1] + sequence[-2])
        handle.publish_feedback(Fibonacci.Feedback(sequence=sequence[-1:]))
        sequence = sequence[-2:]
        time.sleep(0.02)
    (handle.abort if handle.request.order < 0 else handle.succeed)()
    return Fibonacci.Result(sequence=sequence)


def waited(future: Any) -> Any:
    """Return the result of a future, which another thread completes."""
    while not future.done():
        time.sleep(0.01)
    return future.result()


def main() -> None:
    """Run the robot."""
    rclpy.init()
    node = rclpy.create_node("robot", namespace="/one")
    odometry = node.create_publisher(Odometry, "/odom", qos_profile_sensor_data)
    kept = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)
    node.create_publisher(String, "/words", kept).publish(String(data="kept"))
    node.create_subscription(Twist, "/cmd_vel", lambda value: say(f"speed {value.linear.x:g}"), 10)
    node.create_service(SetBool, "/enable", enable)
    ActionServer(node, Fibonacci, "/count", count, cancel_callback=lambda _: CancelResponse.ACCEPT)

    def tell() -> None:
        value = Odometry()
        value.header.frame_id, value.pose.pose.position.x = "odom", 1.5
        odometry.publish(value)

    node.create_timer(0.05, tell)
    executor = MultiThreadedExecutor()
    executor.add_node(node)
    Thread(target=executor.spin, daemon=True).start()
    node.declare_parameter("names", ["left", "right"])
    lines: Queue[str] = Queue()
    rosout = QoSProfile(depth=1000, durability=DurabilityPolicy.TRANSIENT_LOCAL)

    def log(line: Any) -> None:
        if line.name == "kg":
            lines.put(line.msg)

    node.create_subscription(Log, "/rosout", log, rosout)
    say("ready")
    for line in sys.stdin:
        client = AsyncParameterClient(node, line.strip())
        client.wait_for_services()
        say(" ".join(waited(client.list_parameters()).result.names))
        (done,) = waited(client.set_parameters([Parameter("use_sim_time", value=True)])).results
        say(str(done.successful))
        say(lines.get())
    executor.shutdown()
    rclpy.shutdown()


if __name__ == "__main__":
    main()
