#!/usr/bin/env python3

import rospy
from sensor_msgs.msg import Imu, Range
from std_srvs.srv import Empty

THEMES = {"near": {"topic": "near", "kind": Range}, "tilt": {"topic": "tilt", "kind": Imu}}


class Sensor:
    def __init__(self, name):
        self.name = name

    def start_listening(self):
        rospy.Subscriber(self.name, Range, print)


class Manager:
    def __init__(self):
        self.sensors = []
        for side in ("left", "right"):
            self.sensors.append(Sensor(side + "/range"))

    def run(self):
        for sensor in self.sensors:
            sensor.start_listening()
        for theme in rospy.get_param("~themes"):
            rospy.Subscriber(THEMES[theme]["topic"], THEMES[theme]["kind"], print)


if __name__ == "__main__":
    rospy.init_node("manager")
    Manager().run()
    proxy = rospy.ServiceProxy("reset", Empty)
    proxy.wait_for_service(1.0)
    rospy.wait_for_service(proxy.resolved_name)
