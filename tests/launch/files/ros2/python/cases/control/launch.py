from controller_manager.launch_utils import generate_controllers_spawner_launch_description
from launch import LaunchDescription
from launch_ros.actions import Node


def generate_launch_description():
    return LaunchDescription(
        [
            Node(package="controller_manager", executable="ros2_control_node", output={"stdout": "screen"}),
            generate_controllers_spawner_launch_description(
                controller_names=["joint_state_broadcaster"], extra_spawner_args=["--inactive"]
            ),
        ]
    )
