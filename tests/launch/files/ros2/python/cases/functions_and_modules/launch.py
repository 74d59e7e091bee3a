import os
import sys

from launch import LaunchDescription
from launch_ros.actions import Node

sys.path.append(os.path.dirname(__file__))
from beside import LABEL
from helpers import nodes as made
from helpers.nodes import make_node as make, Settings


def local(name, *rest, package="p", **more):
    return Node(package=package, executable=name, arguments=list(rest), **more)


def generate_launch_description():
    settings = Settings("robot")
    shout = lambda text: text.upper()
    return LaunchDescription(
        [
            local("a", "x", "y", output="screen"),
            make("b"),
            made.make_node("c", executable=shout("loud")),
            local(settings.name, package=settings.package()),
            local(LABEL),
        ]
    )
