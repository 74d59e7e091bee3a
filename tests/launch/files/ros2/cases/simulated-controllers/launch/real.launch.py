from launch import LaunchDescription
from launch.actions import ExecuteProcess
from launch.substitutions import Command, PathJoinSubstitution
from launch_ros.actions import Node
from launch_ros.substitutions import FindPackageShare


def generate_launch_description():
    description = Command(["xacro ", PathJoinSubstitution([FindPackageShare("demo"), "urdf", "robot.urdf.xacro"])])
    return LaunchDescription([
        Node(package="robot_state_publisher", executable="robot_state_publisher", name="state", parameters=[{"robot_description": description}]),
        Node(package="demo", executable="create", arguments=["-topic", "robot_description"]),
        ExecuteProcess(cmd=["ros2", "control", "load_controller", "--set-state", "active", "base"]),
    ])
