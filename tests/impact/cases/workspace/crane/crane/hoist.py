"""Lifts loads, and reports its status."""

import rclpy
from crane_msgs.msg import Load, Status
from crane_msgs.srv import Lift
from rclpy.node import Node


class Hoist(Node):
    def __init__(self):
        super().__init__("hoist")
        topic = self.declare_parameter("status_topic", "status").value
        self.limit = self.declare_parameter("limit", 100.0).value
        self.status = self.create_publisher(Status, topic, 10)
        self.create_subscription(Load, "load", self.on_load, 10)
        self.create_service(Lift, "lift", self.on_lift)

    def on_load(self, message):
        if message.mass < self.limit:
            self.status.publish(Status(load=message, moving=False))

    def on_lift(self, request, response):
        response.success = request.height < 10
        return response


def main():
    rclpy.init()
    rclpy.spin(Hoist())
