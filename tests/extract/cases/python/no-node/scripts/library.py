#!/usr/bin/env python3

import rospy
from std_msgs.msg import String


def make():
    return rospy.Publisher("made", String, queue_size=1)
