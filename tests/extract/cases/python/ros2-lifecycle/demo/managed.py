import rclpy
from rclpy.lifecycle import Node
from rclpy.qos import QoSProfile, QoSDurabilityPolicy
from std_msgs.msg import String


class Managed(Node):
    def on_configure(self, state):
        qos = QoSProfile(depth=2)
        qos.durability = QoSDurabilityPolicy.TRANSIENT_LOCAL
        self.pub = self.create_lifecycle_publisher(String, "managed", qos)
        self.declare_parameter("names", rclpy.Parameter.Type.STRING_ARRAY)


def main():
    rclpy.init()
    rclpy.spin(Managed("managed_node"))
