import os

from launch import LaunchDescription
from launch.actions import DeclareLaunchArgument, GroupAction
from launch.substitutions import LaunchConfiguration
from launch_ros.actions import Node


def generate_launch_description():
    description = LaunchDescription(
        [
            DeclareLaunchArgument("side", default_value="left"),
            Node(package="p", executable="e", name="first"),
            DeclareLaunchArgument("camera", default_value="front"),
        ]
    )
    kept = {one.name: LaunchConfiguration(one.name) for one in description.get_launch_arguments()}
    started = Node(package="p", executable="e", name=[LaunchConfiguration("side"), "_", LaunchConfiguration("camera")])
    description.add_action(GroupAction([started], launch_configurations=kept, forwarding=False))
    some = dict(os.environ)
    other = Node(package="p", executable="e", name=[LaunchConfiguration("side"), "_2"])
    description.add_action(GroupAction([other], launch_configurations=some, forwarding=False))
    return description
