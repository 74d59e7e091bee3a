"""The base class of all nodes that talk to the ground."""

from rclpy.node import Node
from std_msgs.msg import String


class GroundLink(Node):
    """A node that tells the ground what it does, on a topic below the name of its subsystem."""

    def __init__(self, name, subsystem):
        super().__init__(name)
        self._report_pub = self.create_publisher(String, f"/ground/{subsystem}/report", 10)
        self.create_subscription(String, "/ground/orders", self.on_order, 10)

    def report(self, text):
        self._report_pub.publish(String(data=text))

    def on_order(self, order):
        self.last_order = order.data
