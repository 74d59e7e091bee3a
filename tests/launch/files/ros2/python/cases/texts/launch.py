import ast
import os

from ament_index_python.packages import get_package_share_directory
from launch import LaunchDescription
from launch.actions import DeclareLaunchArgument, OpaqueFunction
from launch.conditions import IfCondition
from launch.substitutions import LaunchConfiguration
from launch_ros.actions import Node
from nav2_common.launch import HasNodeParams


def listed(context):
    numbers = ast.literal_eval(LaunchConfiguration("numbers").perform(context))
    table = eval(LaunchConfiguration("table").perform(context))
    text = eval(LaunchConfiguration("called").perform(context))
    return [Node(package="p", executable="e", name=f"n{one}") for one in numbers] + [
        Node(package="p", executable="e", name=name, parameters=[{"value": value}]) for name, value in table.items()
    ] + [Node(package="p", executable="e", name=f"t_{text}")]


def generate_launch_description():
    robot = os.environ.get("ROBOT") or "default"
    other = os.environ.get("OTHER") or os.getenv("ROBOT")
    file = os.path.join(get_package_share_directory("demo"), "config", "params.yaml")
    return LaunchDescription([
        DeclareLaunchArgument("numbers", default_value="[1, 2.5]"),
        DeclareLaunchArgument("table", default_value="{'a': None, 'b': (True, 'x')}"),
        DeclareLaunchArgument("called", default_value="__import__('os').getcwd()"),
        OpaqueFunction(function=listed),
        Node(package="p", executable="e", name=robot),
        Node(package="p", executable="e", name=other),
        *[Node(package="p", executable="e", condition=IfCondition(HasNodeParams(source_file=file, node_name=name)))
          for name in ("talker", "listener")],
    ])
