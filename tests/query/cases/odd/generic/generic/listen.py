"""Subscribes to a topic whose type is known at run time only."""
import importlib
import sys

import rclpy
from rclpy.node import Node


class Listen(Node):
    def __init__(self):
        super().__init__("listen")
        module = importlib.import_module(sys.argv[1])
        self.create_subscription(getattr(module, sys.argv[2]), "anything", self.heard, 10)

    def heard(self, message):
        self.get_logger().info(str(message))


def main():
    rclpy.init()
    rclpy.spin(Listen())
