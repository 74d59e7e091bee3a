import glob
import os
import sys
from pathlib import Path

from ament_index_python.packages import get_package_share_directory
from launch import LaunchDescription
from launch.actions import IncludeLaunchDescription
from launch.launch_description_sources import PythonLaunchDescriptionSource
from launch.substitutions import PathJoinSubstitution
from launch_ros.substitutions import FindPackageShare

sys.path.append(os.path.join(get_package_share_directory("demo"), "launch", "lib"))
from starting import start


def generate_launch_description():
    share = FindPackageShare(package="demo").find("demo")
    cameras = os.path.join(share, "config", "cameras")
    return LaunchDescription([
        IncludeLaunchDescription(PythonLaunchDescriptionSource([PathJoinSubstitution([share, "launch", "a.launch.py"])])),
        *[start(os.path.basename(path)) for path in sorted(glob.glob(os.path.join(cameras, "*.yaml")))],
        *[start(name) for name in sorted(os.listdir(cameras)) if name.endswith(".txt")],
        *[start(f"path_{path.stem}") for path in sorted((Path(share) / "config" / "cameras").glob("*.yaml"))],
        *[start(f"in_{path.stem}") for path in Path(share, "config").iterdir()],
        *[start(path) for path in glob.glob("/etc/*")],
    ])
