"""Shows what gauges measure; how many there are is known only when it runs."""

import bus
import rclpy
from rclpy.node import Node
from std_msgs.msg import Float64


class Dial(Node):
    def __init__(self):
        super().__init__("dial")
        for number in range(bus.gauges()):
            topic = self.declare_parameter(f"gauge{number}", "").value
            self.create_subscription(Float64, topic, self.show, 10)
            self.declare_parameter(f"gauge{number}_limit", 1.0)

    def show(self, message):
        self.get_logger().info(f"{message.data}")


def main():
    rclpy.init()
    rclpy.spin(Dial())
