from os.path import join

from ament_index_python.packages import get_package_share_directory
from launch import LaunchDescription
from launch.actions import IncludeLaunchDescription
from launch.launch_description_sources import PythonLaunchDescriptionSource


def generate_launch_description():
    outside = join(get_package_share_directory("nowhere"), "launch", "driver.launch.py")
    return LaunchDescription([IncludeLaunchDescription(PythonLaunchDescriptionSource(outside))])
