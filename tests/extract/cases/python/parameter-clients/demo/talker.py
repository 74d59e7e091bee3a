import rclpy
from rclpy.node import Node
from rclpy.parameter_client import AsyncParameterClient


class Talker(Node):
    def __init__(self):
        super().__init__("talker")
        self.painter = AsyncParameterClient(self, remote_node_name="painter")


def main():
    rclpy.init()
    rclpy.spin(Talker())
