import sys

from launch import LaunchDescription
from launch_ros.actions import Node


def generate_launch_description():
    for arg in sys.argv:
        if arg.startswith("count:="):
            count = int(arg.split(":=")[1])
        elif arg.startswith("start:="):
            start = float(arg.split(":=")[1])
        elif arg.startswith("step:="):
            step = float(arg.split(":=")[1])
    description = LaunchDescription()
    for number in range(count):
        description.add_action(Node(package="p", executable="e", arguments=["-x", str(start + number * step)]))
    return description
