#!/usr/bin/env python3

import rospy
import rostopic
from roslib.message import get_message_class

rospy.init_node("any")
rospy.Subscriber("raw", rospy.AnyMsg, print)
kind, name, _ = rostopic.get_topic_class("in")
rospy.Subscriber(name, kind, print)
rospy.Publisher("out", get_message_class("std_msgs/String"), queue_size=1)
