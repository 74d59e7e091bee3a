import launch
import launch_ros.actions as ros


def generate_launch_description():
    ld = launch.LaunchDescription()
    nodes = [ros.Node(package="p", executable="first")]
    nodes.append(ros.Node(package="p", executable="second"))
    nodes += [ros.Node(package="p", executable="third")]
    nodes.extend([ros.Node(package="p", executable=name) for name in ("fourth", "fifth") if name != "fourth"])
    for node in nodes:
        ld.add_action(node)
    return launch.LaunchDescription(ld.entities + [ros.Node(package="p", executable="last")])
