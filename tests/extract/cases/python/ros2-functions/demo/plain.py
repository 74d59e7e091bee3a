import rclpy
from std_msgs.msg import String


def main():
    rclpy.init()
    node = rclpy.create_node("plain", namespace="ns")
    node.create_publisher(String, "out", qos_profile=1)
    node.create_publisher(String, "~/own", 1)
    node.create_subscription(String, "/abs", print, 1)
