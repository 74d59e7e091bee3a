#!/usr/bin/env python3

import os

import rospy
from std_msgs.msg import String

rospy.init_node("named")
NAMES = dict(first="one", second="two")
rospy.Publisher(rospy.get_name() + "/own", String, queue_size=1)
rospy.Publisher(rospy.resolve_name("~resolved"), String, queue_size=1)
rospy.Publisher(os.path.join("a", "b/", "c"), String, queue_size=1)
rospy.Publisher("//double//slash/", String, queue_size=1)
rospy.Publisher("impl" "icit", String, queue_size=1)
rospy.Publisher(NAMES["second"], String, queue_size=1)
rospy.Publisher(NAMES.get("third", "fallback"), String, queue_size=1)
base = "grow"
base += "/n"
rospy.Publisher(base, String, queue_size=1)
rospy.Publisher("Upper".lower().replace("pp", "tt"), String, queue_size=1)
rospy.Publisher(None or "either", String, queue_size=1)
