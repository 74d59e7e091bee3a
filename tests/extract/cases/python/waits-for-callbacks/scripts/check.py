#!/usr/bin/env python3
import rclpy
from nav_msgs.msg import Odometry
from rclpy.node import Node
from sensor_msgs.msg import Imu, Range
from std_msgs.msg import Bool, Empty, String

distance = None


def measure(message):
    global distance
    distance = message


class Check(Node):
    def __init__(self):
        super().__init__("check")
        self.imu = None

    def on_imu(self, message):
        self.imu = message

    def run(self):
        odometry = None

        def on_odometry(message):
            nonlocal odometry
            odometry = message

        self.create_subscription(Odometry, "odom", on_odometry, 1)
        while odometry is None:
            rclpy.spin_once(self)
        if odometry is None:
            return
        self.create_publisher(Bool, "moves", 1)

        self.create_subscription(Imu, "imu", self.on_imu, 1)
        rclpy.spin_once(self)
        if self.imu is None:
            return
        self.create_publisher(String, "turns", 1)

        self.create_subscription(Range, "range", measure, 1)
        rclpy.spin_once(self)
        if distance is None:
            return
        self.create_publisher(Empty, "near", 1)


rclpy.init()
Check().run()
