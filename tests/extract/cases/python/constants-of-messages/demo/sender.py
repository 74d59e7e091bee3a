import rclpy
from demo.msg import Topics as DemoTopics
from std_msgs.msg import String


def main():
    rclpy.init()
    node = rclpy.create_node("sender")
    node.create_publisher(String, DemoTopics.SPEED, DemoTopics.COUNT)
    node.create_publisher(String, DemoTopics.SPEED + "/twice", 1)
    node.create_publisher(String, DemoTopics.OTHER, 1)
    if not DemoTopics.WANTED:
        node.create_publisher(String, "never", 1)
