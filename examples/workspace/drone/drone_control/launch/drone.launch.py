"""Starts the drone: the flight controller, and the gimbal in a container of its own."""

from launch import LaunchDescription
from launch.actions import DeclareLaunchArgument, GroupAction
from launch.substitutions import LaunchConfiguration
from launch_ros.actions import ComposableNodeContainer, LifecycleNode, PushRosNamespace
from launch_ros.descriptions import ComposableNode


def generate_launch_description():
    name = LaunchConfiguration("name")
    return LaunchDescription([
        DeclareLaunchArgument("name", default_value="drone1"),
        GroupAction([
            PushRosNamespace(name),
            LifecycleNode(
                package="drone_control",
                executable="flight_controller",
                name="flight_controller",
                namespace="",
                parameters=[{"gains.p": 1.2, "simulated": True}],
                remappings=[("odometry", "vio/odometry")],
            ),
            ComposableNodeContainer(
                name="camera_container",
                namespace="",
                package="rclcpp_components",
                executable="component_container",
                composable_node_descriptions=[
                    ComposableNode(
                        package="drone_control",
                        plugin="drone_control::Gimbal",
                        name="gimbal",
                        parameters=[{"picture_topic": "front/image_raw"}],
                    ),
                ],
            ),
        ]),
    ])
