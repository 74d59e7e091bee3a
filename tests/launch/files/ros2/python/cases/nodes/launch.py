from launch import LaunchDescription
from launch.conditions import IfCondition, UnlessCondition
from launch.actions import Shutdown
from launch.substitutions import LaunchConfiguration
from launch_ros.actions import LifecycleNode, Node

simulated = LaunchConfiguration("simulated", default="false")


def generate_launch_description():
    return LaunchDescription(
        [
            Node(
                package="camera",
                executable="driver",
                name="front",
                namespace=["/robot", simulated],
                remappings=[
                    ("image", "/front/image"),
                    ("info", simulated),
                ],
                arguments=["--mode", ["a", simulated]],
                ros_arguments=["--log-level", "debug"],
                output="screen",
                respawn=True,
                additional_env={"LANG": "C"},
                on_exit=Shutdown(),
                condition=IfCondition(simulated),
            ),
            Node(package="old", node_executable="names", node_name="n", node_namespace="ns"),
            LifecycleNode(
                package="camera", executable="managed", name="m", namespace="", condition=UnlessCondition(simulated)
            ),
        ]
    )
