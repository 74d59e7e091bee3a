from launch import LaunchDescription
from launch.actions import DeclareLaunchArgument, OpaqueFunction
from launch.conditions import IfCondition
from launch.substitutions import LaunchConfiguration
from launch_ros.actions import ComposableNodeContainer, Node
from launch_ros.descriptions import ComposableNode


def make_of(model):
    if model.startswith("a"):
        return "Alpha", ".csv"
    elif model.startswith("b"):
        return "Beta", ".yaml"
    return "Other", ""


def setup(context):
    make, ending = make_of(LaunchConfiguration("model").perform(context))
    driver = ComposableNode(package="p", plugin=make + "Driver", name=make.lower() + "_driver")
    monitor = ComposableNode(
        package="p", plugin=make + "Monitor", name="monitor", condition=IfCondition(LaunchConfiguration("watch"))
    )
    return [
        ComposableNodeContainer(
            package="rclcpp_components",
            executable="component_container",
            name="box",
            namespace="",
            composable_node_descriptions=[driver, monitor],
        ),
        Node(package="p", executable=make.lower(), name=f"{make}{ending}"),
    ]


def generate_launch_description():
    return LaunchDescription([
        DeclareLaunchArgument("model"),
        DeclareLaunchArgument("watch", default_value="true"),
        OpaqueFunction(function=setup),
    ])
