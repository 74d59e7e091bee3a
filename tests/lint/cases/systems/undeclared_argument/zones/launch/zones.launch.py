from launch import LaunchDescription
from launch.actions import DeclareLaunchArgument
from launch.substitutions import LaunchConfiguration
from launch_ros.actions import Node


def generate_launch_description():
    rate = LaunchConfiguration("rate")
    autostart = LaunchConfiguration("autostart")
    manager = Node(
        package="managers",
        executable="manager",
        name="zone_manager",
        parameters=[{"rate": rate, "autostart": autostart}],
    )
    return LaunchDescription([DeclareLaunchArgument("rate", default_value="5"), manager])
