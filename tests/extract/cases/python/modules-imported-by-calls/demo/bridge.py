import rclpy
from rclpy.node import Node
from std_srvs.srv import Trigger


class Bridge:
    def __init__(self):
        rclpy.init()
        self.node = Node("bridge")

    def call(self, name):
        client = self.node.create_client(Trigger, name)
        client.call(Trigger.Request())
