#!/usr/bin/env python3

import os

import rospy
from std_msgs.msg import String

rospy.init_node("reader")
topic = rospy.get_param("~topic", "default_topic")
rospy.Publisher(topic, String, queue_size=1)
rospy.Publisher(rospy.get_param("~prefix", "base") + "/out", String, queue_size=1)
rospy.Publisher(rospy.get_param("~unset"), String, queue_size=1)
rospy.Publisher("robot/" + rospy.get_param("/name"), String, queue_size=1)
rate = rospy.get_param("~rate", 10.5)
joints = rospy.get_param("~joints", ["a", "b"])
if rospy.has_param("/use_sim_time"):
    rospy.set_param("~ready", True)
rospy.delete_param("/old")
simulated = rospy.get_param("~simulated", os.environ.get("SIMULATED", False))
