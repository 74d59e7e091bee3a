from launch_ros.actions import Node


def start(name):
    return Node(package="p", executable="e", name=name)
