#!/usr/bin/env python3

import rospy
from std_msgs.msg import String

rospy.init_node("broken")
x = = 3
rospy.Publisher("after", String, queue_size=1)
