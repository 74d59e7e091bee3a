#!/usr/bin/env python3

import actionlib
import rospy
from demo.msg import *
from geometry_msgs.msg import *
from other_msgs.msg import *
from sensor_msgs.msg import *

rospy.init_node("stars")
rospy.Publisher("own", Own, queue_size=1)
rospy.Publisher("pose", PoseStamped, queue_size=1)
rospy.Publisher("scan", LaserScan, queue_size=1)
rospy.Publisher("elsewhere", Special, queue_size=1)
actionlib.SimpleActionServer("do", DoAction, print, False)
