from launch import LaunchDescription
from launch.conditions import UnlessCondition
from launch.substitutions import LaunchConfiguration
from launch_ros.actions import Node
from launch_ros.parameter_descriptions import ParameterFile
from nav2_common.launch import ReplaceString, RewrittenYaml


def generate_launch_description():
    namespace = LaunchConfiguration("namespace")
    params = ReplaceString(
        source_file=LaunchConfiguration("params_file"),
        replacements={"<robot_namespace>": ("/", namespace)},
        condition=UnlessCondition("false"),
    )
    configured = ParameterFile(
        RewrittenYaml(source_file=params, param_rewrites={"plugin": "demo/Planner"}), allow_substs=True
    )
    return LaunchDescription(
        [
            Node(package="p", executable="amcl", namespace=namespace, name="amcl", parameters=[configured]),
            Node(package="p", executable="controller", namespace=namespace, name="controller", parameters=[configured]),
        ]
    )
