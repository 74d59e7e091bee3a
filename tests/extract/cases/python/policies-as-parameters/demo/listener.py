import message_filters
import rclpy
from rclpy.node import Node
from rclpy.qos import QoSHistoryPolicy, QoSProfile, QoSReliabilityPolicy
from std_msgs.msg import Header, String


class Listener(Node):
    def __init__(self):
        super().__init__("listener")
        self.declare_parameter("reliability", QoSReliabilityPolicy.BEST_EFFORT)
        self.declare_parameter("how", "best_effort")
        reliability = self.get_parameter("reliability").get_parameter_value().integer_value
        profile = QoSProfile(reliability=reliability, history=QoSHistoryPolicy.KEEP_LAST, depth=3)
        self.texts = message_filters.Subscriber(self, String, "texts", qos_profile=profile)
        self.headers = message_filters.Subscriber(self, Header, "headers")


def main():
    rclpy.init()
    rclpy.spin(Listener())
