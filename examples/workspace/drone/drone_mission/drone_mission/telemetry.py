"""Gathers what the ground wants to know of the drone."""

import os

import rclpy
from rclpy.qos import qos_profile_sensor_data
from sensor_msgs.msg import BatteryState, FluidPressure, NavSatFix
from std_msgs.msg import Float32

from drone_mission.ground_link import GroundLink

SENSORS = [("gps/fix", NavSatFix), ("air/pressure", FluidPressure), ("battery", BatteryState)]
MOTORS = ["front_left", "front_right", "rear_left", "rear_right"]


class Telemetry(GroundLink):
    def __init__(self):
        super().__init__("telemetry", "telemetry")
        for topic, kind in SENSORS:
            self.create_subscription(kind, topic, self.on_sensor, qos_profile_sensor_data)
        self.motor_pubs = {motor: self.create_publisher(Float32, f"motors/{motor}/load", 1) for motor in MOTORS}

        # Only the machine that runs the node knows this name.
        self.radio_pub = self.create_publisher(Float32, os.environ["DRONE_RADIO_TOPIC"], 1)
        self.create_timer(1.0, self.on_timer)

    def on_sensor(self, msg):
        self.report(f"{type(msg).__name__} arrived")

    def on_timer(self):
        self.radio_pub.publish(Float32(data=1.0))


def main(args=None):
    rclpy.init(args=args)
    node = Telemetry()
    try:
        rclpy.spin(node)
    except KeyboardInterrupt:
        pass
    finally:
        node.destroy_node()
        rclpy.try_shutdown()
