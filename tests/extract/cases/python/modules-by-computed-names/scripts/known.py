#!/usr/bin/env python
import importlib

import rospy

json = importlib.import_module("json")

if __name__ == "__main__":
    rospy.init_node("known")
    rospy.spin()
