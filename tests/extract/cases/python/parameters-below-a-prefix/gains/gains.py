import rclpy
from rclpy.node import Node
from std_msgs.msg import Int32


class Gains(Node):
    def __init__(self):
        super().__init__("gains", automatically_declare_parameters_from_overrides=True)
        self.gains = self.get_parameters_by_prefix("gains")
        for name, topic in self.get_parameters_by_prefix("topics").items():
            self.create_publisher(Int32, topic.value, 1)


def main():
    rclpy.init()
    rclpy.spin(Gains())
