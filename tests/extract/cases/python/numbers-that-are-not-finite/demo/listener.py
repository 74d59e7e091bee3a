import math

import rclpy
from rclpy.node import Node


class Listener(Node):
    def __init__(self):
        super().__init__("listener")
        self.declare_parameter("range.max", math.inf)
        self.declare_parameter("range.min", -math.inf)
        self.declare_parameter("offset", float("nan"))


def main():
    rclpy.init()
    rclpy.spin(Listener())
