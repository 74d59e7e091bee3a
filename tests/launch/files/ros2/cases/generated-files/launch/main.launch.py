from launch import LaunchDescription
from launch.actions import DeclareLaunchArgument, IncludeLaunchDescription
from launch.conditions import IfCondition
from launch.launch_description_sources import PythonLaunchDescriptionSource
from launch.substitutions import LaunchConfiguration, ThisLaunchFileDir
from launch_ros.actions import Node
from nav2_common.launch import ReplaceString, RewrittenYaml


def generate_launch_description():
    namespace = LaunchConfiguration("namespace")
    params = [ThisLaunchFileDir(), "/../config/nav.yaml"]
    rewritten = RewrittenYaml(
        source_file=params,
        root_key=namespace,
        param_rewrites={"use_sim_time": "true"},
        value_rewrites={"ZONE_ENABLED": LaunchConfiguration("zone")},
        convert_types=True,
    )
    replaced = ReplaceString(
        source_file=params,
        replacements={"<robot_namespace>": ("/", namespace)},
        condition=IfCondition(LaunchConfiguration("use_namespace")),
    )
    unknown = ReplaceString(
        source_file=params, replacements={"a": "b"}, condition=IfCondition(LaunchConfiguration("which"))
    )
    return LaunchDescription(
        [
            DeclareLaunchArgument("namespace", default_value="r1"),
            DeclareLaunchArgument("use_namespace", default_value="true"),
            DeclareLaunchArgument("which"),
            DeclareLaunchArgument("zone", default_value="True"),
            Node(package="p", executable="amcl", name="amcl", parameters=[replaced], arguments=["-d", replaced]),
            Node(package="p", executable="amcl", name="amcl", parameters=[unknown]),
            IncludeLaunchDescription(
                PythonLaunchDescriptionSource([ThisLaunchFileDir(), "/inner.launch.py"]),
                launch_arguments={"params_file": rewritten, "namespace": namespace, "odom": "/odom"}.items(),
            ),
        ]
    )
