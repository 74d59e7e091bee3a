#!/usr/bin/env python3
import rclpy
from rclpy.node import Node
from sensor_msgs.msg import Imu


class Converter(Node):
    def __init__(self):
        super().__init__("converter")
        self.unused = self.create_publisher(Imu, "unused", 1)
        self.out = self.create_publisher(Imu, "out", 1)
        self.given = self.create_publisher(Imu, "given", 1)
        self.create_subscription(Imu, "in", self.receive, 1)
        self.send(self.given)

    def receive(self, imu):
        self.out.publish(imu)

    def send(self, publisher):
        publisher.publish(Imu())

    def stop(self):
        if self.unused is not None:
            self.destroy_publisher(self.unused)


if __name__ == "__main__":
    rclpy.init()
    rclpy.spin(Converter())
