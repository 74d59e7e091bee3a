"""Shows the status of the hoist."""

import rclpy
from crane_msgs.msg import Status
from crane_msgs.srv import Lift
from rclpy.node import Node


class Panel(Node):
    def __init__(self):
        super().__init__("panel")
        self.create_subscription(Status, "status", self.show, 10)
        self.lift = self.create_client(Lift, "lift")

    def show(self, message):
        self.get_logger().info(f"{message.load.mass} kg")


def main():
    rclpy.init()
    rclpy.spin(Panel())
