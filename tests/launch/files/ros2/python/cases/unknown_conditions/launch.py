import os
import platform

from launch import LaunchDescription
from launch_ros.actions import Node


def chosen():
    if platform.machine() == "arm":
        return [Node(package="p", executable="arm")]
    return [Node(package="p", executable="other")]


def generate_launch_description():
    ld = LaunchDescription()
    if os.environ["MODEL"] == "a":
        name = "one"
        ld.add_action(Node(package="p", executable="only_a"))
    else:
        name = "two"
    ld.add_action(Node(package="p", executable="either", name=name))
    for action in chosen():
        ld.add_action(action)
    if os.environ.get("ROBOT", "small") == "small":
        ld.add_action(Node(package="p", executable="small", name=os.environ.get("ROBOT", "small")))
    if not os.path.exists("/nowhere"):
        raise RuntimeError("nothing there")
    ld.add_action(Node(package="p", executable="x" if platform.node() else "y"))
    ld.add_action(platform.anything())
    return ld
