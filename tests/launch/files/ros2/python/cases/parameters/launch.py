import os

import yaml
from ament_index_python.packages import get_package_share_directory
from launch import LaunchDescription
from launch.substitutions import Command, LaunchConfiguration
from launch_ros.actions import Node, SetParameter, SetParametersFromFile, SetUseSimTime
from launch_ros.parameter_descriptions import ParameterFile, ParameterValue

RATE = 10


def generate_launch_description():
    share = get_package_share_directory("demo")
    with open(os.path.join(share, "config", "tuning.yaml")) as stream:
        tuning = yaml.safe_load(stream)["driver"]["ros__parameters"]
    mode = LaunchConfiguration("mode")
    return LaunchDescription(
        [
            SetParameter(name="all", value=2 * RATE),
            SetUseSimTime(True),
            SetParametersFromFile(os.path.join(share, "config/all.yaml")),
            Node(
                package="camera",
                executable="driver",
                parameters=[
                    os.path.join(share, "config", "tuning.yaml"),
                    {
                        "rate": RATE / 4,
                        "text": "5",
                        "flag": not True,
                        "gains": {"p": 1, "limits": {"low": -1.5}},
                        "names": ["a", "b"],
                        "one_text": [mode, "/x"],
                        "mode": mode,
                        "model": ParameterValue(Command(["xacro ", mode]), value_type=str),
                    },
                    tuning,
                    ParameterFile([share, "/config/", mode, ".yaml"], allow_substs=True),
                    {**tuning, "rate": 7},
                ],
            ),
        ]
    )
