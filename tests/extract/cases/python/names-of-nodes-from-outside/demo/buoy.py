"""A class of another library names the node."""

import rclpy
from harbour_kit import Float
from std_msgs.msg import String


class Buoy(Float):
    def __init__(self):
        super().__init__()
        self.light = self.create_publisher(String, "~/light", 1)


def main():
    rclpy.init()
    rclpy.spin(Buoy())
