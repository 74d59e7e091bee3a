from launch import LaunchDescription
from launch.actions import IncludeLaunchDescription, SetEnvironmentVariable
from launch.launch_description_sources import PythonLaunchDescriptionSource
from launch.substitutions import PathJoinSubstitution
from launch_ros.substitutions import FindPackageShare


def included():
    path = PathJoinSubstitution([FindPackageShare('demo'), 'launch', 'variables.launch.py'])
    return IncludeLaunchDescription(PythonLaunchDescriptionSource(path))


def generate_launch_description():
    return LaunchDescription([
        included(),
        SetEnvironmentVariable('ROBOTS', 'left,right'),
        SetEnvironmentVariable('MONITOR', 'second'),
        included(),
    ])
