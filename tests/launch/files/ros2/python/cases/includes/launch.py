from pathlib import Path

from ament_index_python.packages import get_package_share_path
from launch import LaunchDescription
from launch.actions import GroupAction, IncludeLaunchDescription
from launch.launch_description_sources import AnyLaunchDescriptionSource, PythonLaunchDescriptionSource
from launch.substitutions import LaunchConfiguration, PathSubstitution, ThisLaunchFileDir
from launch_ros.actions import PushRosNamespace, SetRemap
from launch_ros.substitutions import FindPackageShare

HERE = Path(__file__).parent.resolve()


def generate_launch_description():
    common = {"mode": "a", "count": 2}
    return LaunchDescription(
        [
            IncludeLaunchDescription(
                PythonLaunchDescriptionSource(str(HERE / "launch" / "x.launch.py")),
                launch_arguments={**common, "mode": LaunchConfiguration("mode")}.items(),
            ),
            IncludeLaunchDescription(
                AnyLaunchDescriptionSource([FindPackageShare("other"), "/launch/y.xml"]), launch_arguments=[("a", "b")]
            ),
            IncludeLaunchDescription(PathSubstitution(FindPackageShare("other")) / "launch" / "z.yaml"),
            IncludeLaunchDescription([ThisLaunchFileDir(), "/w.launch.py"]),
            GroupAction(
                actions=[
                    PushRosNamespace("front"),
                    SetRemap(src="a", dst="b"),
                    IncludeLaunchDescription(str(get_package_share_path("third").joinpath("v.launch.py"))),
                ],
                scoped=False,
                launch_configurations={"inner": "1"},
            ),
            IncludeLaunchDescription(PythonLaunchDescriptionSource(LaunchConfiguration("which"))),
            IncludeLaunchDescription(something_unknown()),
        ]
    )
