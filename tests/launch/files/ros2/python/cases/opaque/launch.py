from launch import LaunchDescription
from launch.actions import DeclareLaunchArgument, OpaqueFunction
from launch.conditions import IfCondition
from launch.substitutions import LaunchConfiguration, PathJoinSubstitution
from launch_ros.actions import Node
from launch_ros.substitutions import FindPackageShare


def setup(context, suffix, *, package):
    mode = LaunchConfiguration("mode").perform(context)
    count = int(context.launch_configurations["count"])
    path = PathJoinSubstitution([FindPackageShare("demo"), mode + ".yaml"]).perform(context)
    found = []
    if mode == "fast":
        found = [Node(package=package, executable="fast", parameters=[path])]
    elif IfCondition(LaunchConfiguration("extra")).evaluate(context):
        found.append(Node(package=package, executable="extra"))
    if LaunchConfiguration("unset_by_caller").perform(context) == "x":
        found.append(Node(package=package, executable="maybe"))
    return found + [Node(package=package, executable=f"n{i}{suffix}") for i in range(count)]


def generate_launch_description():
    return LaunchDescription(
        [
            DeclareLaunchArgument("mode", default_value="slow", choices=["slow", "fast"], description="how"),
            DeclareLaunchArgument("count", default_value="2"),
            DeclareLaunchArgument("extra", default_value="true"),
            DeclareLaunchArgument("unset_by_caller"),
            OpaqueFunction(function=setup, args=["_x"], kwargs={"package": "p"}),
        ]
    )
