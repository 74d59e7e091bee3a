from launch import LaunchDescription
from launch_ros.actions import ComposableNodeContainer, LoadComposableNodes
from launch_ros.descriptions import ComposableNode


def generate_launch_description():
    container = ComposableNodeContainer(
        name="container",
        namespace="ns",
        package="rclcpp_components",
        executable="component_container_mt",
        composable_node_descriptions=[
            ComposableNode(
                package="image_proc",
                plugin="image_proc::RectifyNode",
                name="rectify",
                remappings=[("image", "image_raw")],
                parameters=[{"queue_size": 5}],
                extra_arguments=[{"use_intra_process_comms": True}],
            ),
        ],
    )
    loaded = ComposableNode(package="image_proc", plugin="image_proc::CropNode")
    return LaunchDescription(
        [
            container,
            LoadComposableNodes(target_container=container, composable_node_descriptions=[loaded]),
            LoadComposableNodes(target_container="elsewhere", composable_node_descriptions=[loaded]),
        ]
    )
