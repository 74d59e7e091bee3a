#!/usr/bin/env python
import importlib
import sys

import rospy

json = importlib.import_module("json")

if __name__ == "__main__":
    rospy.init_node("plugins")
    importlib.import_module("plugins." + sys.argv[1]).start()
    rospy.spin()
