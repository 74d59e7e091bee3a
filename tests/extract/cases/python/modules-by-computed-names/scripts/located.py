#!/usr/bin/env python
import pydoc

import rospy

if __name__ == "__main__":
    rospy.init_node("located")
    pydoc.locate(rospy.get_param("~class"))()
    rospy.spin()
