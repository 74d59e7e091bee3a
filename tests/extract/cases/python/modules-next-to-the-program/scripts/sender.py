#!/usr/bin/env python
import rospy
from tools.output import Output

if __name__ == "__main__":
    rospy.init_node("sender")
    Output()
    rospy.spin()
