import platform

from launch import LaunchDescription
from launch.actions import DeclareLaunchArgument
from launch_ros.actions import Node


def extend(found, name):
    found.append(Node(package="p", executable=name))


def renamed(arguments, suffix):
    for argument in arguments:
        argument["name"] += suffix
    return arguments


def generate_launch_description():
    ld = LaunchDescription()
    found = []
    extend(found, "first")
    for argument in renamed([{"name": "map"}, {"name": "mode"}], "_file"):
        ld.add_action(DeclareLaunchArgument(argument["name"], default_value="x"))
    for name in ("a", "b"):
        if platform.machine() == name:
            continue
        extend(found, name)
    if platform.system() == "arm":
        ld.add_action(Node(package="p", executable="arm"))
        return ld
    topic = "left/scan" if platform.node() else "right/scan"
    ld.add_action(Node(package="p", executable="e", arguments=[topic], remappings=[("scan", topic)]))
    return LaunchDescription([ld, *found])
