#!/usr/bin/env python3
import rospy
from sensor_msgs.msg import Imu
from std_msgs.msg import Bool

rospy.init_node("driver")
rospy.Publisher("imu", Imu, queue_size=1)
rospy.Subscriber("commands", Bool, print)
rospy.spin()
