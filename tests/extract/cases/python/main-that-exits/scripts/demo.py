import sys

import rclpy
from rclpy.node import Node
from std_msgs.msg import Bool


def main(arguments=None):
    rclpy.init(args=arguments)
    node = Node("demo")
    node.create_publisher(Bool, "state", 1)
    rclpy.spin(node)
    return 0


if __name__ == "__main__":
    raise SystemExit(main(sys.argv[1:]))
