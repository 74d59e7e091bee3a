from launch_ros.actions import Node

PACKAGE = "helpers"


class Settings:
    def __init__(self, name):
        self.name = name + "_settings"

    def package(self):
        return PACKAGE


def make_node(name, executable="run"):
    return Node(package=PACKAGE, executable=executable, name=name)
