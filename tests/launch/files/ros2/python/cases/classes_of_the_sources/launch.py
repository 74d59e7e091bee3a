from launch import LaunchDescription
from launch.actions import DeclareLaunchArgument, IncludeLaunchDescription
from launch.conditions import IfCondition
from launch.launch_description_sources import AnyLaunchDescriptionSource
from launch.substitutions import LaunchConfiguration
from launch_ros.actions import Node
from tools.launching import Address, Both, Camera, Driver, Foreign, LaunchFile, Notify


def generate_launch_description():
    return LaunchDescription([
        DeclareLaunchArgument("prefix", default_value="demo_"),
        DeclareLaunchArgument("right", default_value="true"),
        IncludeLaunchDescription(AnyLaunchDescriptionSource(LaunchFile("demo", "other.launch.xml"))),
        Notify("http://localhost"),
        Driver("left", namespace="arm"),
        Camera("right", condition=IfCondition(LaunchConfiguration("right"))),
        Both(["one", "two"]),
        Node(package="demo", executable="client", parameters=[{"address": Address("robot")}]),
        Foreign(),
    ])
