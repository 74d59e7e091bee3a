import rclpy
from rclpy.lifecycle import Node
from std_msgs.msg import String
from vendor.device import Device


class Driver(Node):
    """Its framework runs transitions once, so their conditions say as much as those of a constructor."""

    def on_configure(self, state):
        device = Device()
        if device.has_imu():
            self.imu = self.create_publisher(String, "imu", 10)
        self.data = self.create_publisher(String, "data", 10)
        self.orders = self.create_subscription(String, "orders", self.obey, 10)

    def obey(self, order):
        # Some message will ask for it.
        if order.data == "report":
            self.report = self.create_publisher(String, "report", 10)


def main():
    rclpy.init()
    rclpy.spin(Driver("driver"))
