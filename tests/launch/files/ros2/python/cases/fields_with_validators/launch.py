import os
import sys

from launch import LaunchDescription
from launch_ros.actions import Node

sys.path.append(os.path.dirname(os.path.realpath(__file__)))
from cameras import Camera, Opaque

CAMERAS = []
CAMERAS.append(Camera(name="front"))
CAMERAS.append(Camera(namespace="rear", remappings=[("a", "b")]))
CAMERAS.append(Opaque(name="side"))


def generate_launch_description():
    nodes = [
        Node(package="p", executable="a", name=one.name, namespace=one.namespace, remappings=one.remappings)
        for one in CAMERAS
    ]
    return LaunchDescription(nodes)
