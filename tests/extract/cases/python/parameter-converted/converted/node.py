import rclpy
from rclpy.node import Node


class Converted(Node):
    def __init__(self):
        super().__init__("converted")
        self.declare_parameter("speed")
        self.speed = self.get_parameter("speed").get_parameter_value().double_value
        self.names = self.get_parameter("names").get_parameter_value().string_array_value


def main():
    rclpy.init()
    rclpy.spin(Converted())
