#!/usr/bin/env python3
import rospy
from std_srvs.srv import Trigger

if __name__ == "__main__":
    rospy.wait_for_service("stop")
    rospy.ServiceProxy("stop", Trigger)()
