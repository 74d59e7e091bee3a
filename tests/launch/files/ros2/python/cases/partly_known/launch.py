import os
from collections import defaultdict

from launch import LaunchDescription
from launch.actions import IncludeLaunchDescription
from launch.launch_description_sources import PythonLaunchDescriptionSource
from launch.substitutions import LaunchConfiguration
from launch_ros.actions import Node

robot = os.environ.get("ROBOT")


def generate_launch_description():
    ld = LaunchDescription()
    for name in os.listdir("robots"):
        if name == "skipped":
            continue
        ld.add_action(Node(package="p", executable="each", namespace=f"robots/{name}"))
    groups = defaultdict(list)
    for key, value in (("a", 1), ("b", 2), ("a", 3)):
        groups[key].append(value)
    arguments = {"known": "1"}
    if robot:
        arguments["robot"] = robot
    ld.add_action(Node(package="p", executable="e", name="n_%s" % robot, parameters=[groups]))
    ld.add_action(
        IncludeLaunchDescription(
            PythonLaunchDescriptionSource(os.path.join(os.path.dirname(__file__), "..", "x", f"{robot}.launch.py")),
            launch_arguments=arguments.items(),
        )
    )
    compared = "never" if LaunchConfiguration("a") == "b" else "always"
    ld.add_action(Node(package="p", executable=compared, remappings=[("a", "b")] if robot else []))
    return ld
