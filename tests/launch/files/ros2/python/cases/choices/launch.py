import platform

from launch import LaunchDescription
from launch.actions import DeclareLaunchArgument, ExecuteProcess, OpaqueFunction
from launch.substitutions import LaunchConfiguration
from launch_ros.actions import Node


def by_mode(context):
    match LaunchConfiguration("mode").perform(context):
        case "fast" | "faster":
            return [Node(package="p", executable="fast")]
        case "slow":
            return [Node(package="p", executable="slow")]
        case other:
            return [Node(package="p", executable=other)]


def generate_launch_description():
    if platform.machine() == "arm":
        name, rate = "arm", 5
    else:
        name, rate = "other", 10
    return LaunchDescription(
        [
            DeclareLaunchArgument("mode", default_value="slow"),
            OpaqueFunction(function=by_mode),
            Node(package="p", executable="e", name=name, parameters=[{"rate": rate, "fixed": 1}]),
            Node(package="p", executable="e", parameters=[{"a": 1}] if platform.node() else []),
            ExecuteProcess(cmd="ros2 run p tool --ros-args -r 'a:=b c'", shell=True),
        ]
    )
