#!/usr/bin/env python
import os

import outside
import rospy
from std_msgs.msg import String


class Talker:
    def __init__(self, name):
        self._name = name
        rospy.Publisher(self._name + "/member", String, queue_size=1)
        rospy.Publisher("{}/formatted".format(name), String, queue_size=1)


rospy.init_node(outside.chosen_name())
rospy.Publisher(os.environ.get("TOPIC") or "scan", String, queue_size=1)
rospy.Publisher(os.environ.get("ROBOT", "rover") + "/default", String, queue_size=1)
rospy.Publisher(os.environ["SIDE"] + "/index", String, queue_size=1)
rospy.Publisher(os.getenv("SIDE", outside.side()) + "/outside", String, queue_size=1)

prefix = rospy.get_param("~frame_prefix")
rospy.Publisher(prefix + "odom", String, queue_size=1)
rospy.Publisher(f"cams/{outside.camera_name()}/image", String, queue_size=1)
config = outside.load("config.yaml")
rospy.Publisher(f"{config.robot}/{config.side}/state", String, queue_size=1)
for name in outside.names():
    rospy.Publisher(f"each/{name}", String, queue_size=1)
for i in range(outside.count()):
    rospy.Publisher("odom%d" % i, String, queue_size=1)
rospy.Publisher(rospy.get_name() + "_action", String, queue_size=1)
rospy.Publisher("/robots/%s/state" % rospy.get_name(), String, queue_size=1)
rospy.get_param(rospy.get_name() + "/rate", 1.0)
Talker(outside.side().strip())
rospy.spin()
