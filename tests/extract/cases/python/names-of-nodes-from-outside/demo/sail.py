"""A part of the name is an argument of the command line."""

import sys

import rclpy
from rclpy.node import Node
from std_msgs.msg import String


class Sail(Node):
    def __init__(self, mast):
        super().__init__("sail_" + mast)
        self.wind = self.create_publisher(String, "~/wind", 1)


def main():
    rclpy.init()
    rclpy.spin(Sail(sys.argv[1]))
