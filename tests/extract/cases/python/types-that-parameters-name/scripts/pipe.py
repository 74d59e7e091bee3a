#!/usr/bin/env python
import importlib

import roslib.message
import rospy


def message_class(text):
    package, name = text.split("/")
    return getattr(importlib.import_module(package + ".msg"), name)


rospy.init_node("pipe")
kind = message_class(rospy.get_param("~type", "std_msgs/String"))
out = rospy.Publisher("out", kind, queue_size=1)
rospy.Subscriber("in", kind, out.publish)
rospy.Subscriber("fixed", message_class("std_msgs/Bool"), print)
rospy.Subscriber("other", roslib.message.get_message_class(rospy.get_param("~other", "std_msgs/Int8")), print)
rospy.spin()
