from collections import namedtuple
from functools import partial

import rclpy
from rclpy.node import Node
from std_msgs.msg import String

Wanted = namedtuple("Wanted", "name depth")
Named = namedtuple("Named", ["name", "depth"])


class Makers(Node):
    def __init__(self):
        super().__init__("makers")
        make = partial(self.create_publisher, String, qos_profile=1)
        make("one")
        for wanted in (Wanted("two", 2), Named(name="three", depth=3)):
            self.create_publisher(String, wanted.name, wanted.depth)
        node = partial(Node, "other")
        node().create_publisher(String, "four", 1)


def main():
    rclpy.init()
    rclpy.spin(Makers())
