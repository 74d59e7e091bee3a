#!/usr/bin/env python3
import rclpy
from press.srv._load_plate import *
from rclpy.node import Node
from sensor_msgs.msg._joint_state import JointState


class Press(Node):
    def __init__(self):
        super().__init__("press")
        self.load = self.create_service(LoadPlate, "load", self.on_load)
        self.joints = self.create_publisher(JointState, "joints", 1)

    def on_load(self, request: LoadPlate_Request, response):
        return response


rclpy.init()
rclpy.spin(Press())
