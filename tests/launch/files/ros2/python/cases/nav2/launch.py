import os

from launch import LaunchDescription
from launch.substitutions import LaunchConfiguration
from launch_ros.actions import Node
from launch_ros.descriptions import ParameterFile
from nav2_common.launch import RewrittenYaml


def generate_launch_description():
    namespace = LaunchConfiguration("namespace")
    configured = ParameterFile(
        RewrittenYaml(
            source_file=LaunchConfiguration("params_file"),
            root_key=namespace,
            param_rewrites={"autostart": LaunchConfiguration("autostart"), "use_sim_time": "true"},
            convert_types=True,
        ),
        allow_substs=True,
    )
    lifecycle_nodes = ["a", "b"]
    remappings = [("/tf", "tf"), ("/tf_static", "tf_static")]
    return LaunchDescription(
        [
            Node(
                package="nav2_lifecycle_manager",
                executable="lifecycle_manager",
                parameters=[configured, {"node_names": lifecycle_nodes}],
                remappings=remappings + [("cmd_vel", "cmd_vel_nav")],
            )
        ]
    )
