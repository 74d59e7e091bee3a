import rclpy
from example_interfaces.action import Fibonacci
from example_interfaces.srv import AddTwoInts
from rclpy.action import ActionClient, ActionServer
from rclpy.node import Node
from rclpy.qos import QoSProfile, ReliabilityPolicy, DurabilityPolicy, qos_profile_sensor_data
from sensor_msgs.msg import LaserScan
from std_msgs.msg import String


class Talker(Node):
    def __init__(self):
        super().__init__("talker")
        self.declare_parameter("topic", "chatter")
        self.declare_parameters(namespace="", parameters=[("frame", "map"), ("rate", 2.0)])
        latched = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)
        self.pub = self.create_publisher(String, self.get_parameter("topic").value, 10)
        self.map = self.create_publisher(String, "~/map", latched)
        name = self.get_parameter("frame").get_parameter_value().string_value
        self.frames = self.create_publisher(String, name, QoSProfile(depth=5, reliability=ReliabilityPolicy.BEST_EFFORT))
        self.sub = self.create_subscription(LaserScan, "scan", self.heard, qos_profile_sensor_data)
        self.service = self.create_service(AddTwoInts, "add", self.add)
        self.client = self.create_client(srv_type=AddTwoInts, srv_name="/other/add")
        self.server = ActionServer(self, Fibonacci, "fibonacci", self.run)
        self.actor = ActionClient(self, Fibonacci, "count")

    def heard(self, message):
        pass

    def add(self, request, response):
        return response

    def run(self, goal):
        return Fibonacci.Result()


def main(args=None):
    rclpy.init(args=args)
    rclpy.spin(Talker())
