#!/usr/bin/env python3

import rospy
from sensor_msgs.msg import LaserScan
from std_msgs.msg import String
import std_srvs.srv


def heard(message):
    del message


def served(request):
    return std_srvs.srv.TriggerResponse(success=bool(request))


def main():
    rospy.init_node("talker")
    rospy.Publisher("chatter", String, queue_size=1)
    rospy.Subscriber("/scan", LaserScan, heard)
    rospy.Service("~reset", std_srvs.srv.Trigger, served)
    rospy.wait_for_service("add")
    rospy.ServiceProxy("add", std_srvs.srv.SetBool)
    rospy.wait_for_service("later")
    rospy.wait_for_message("start", String)
    rospy.spin()


if __name__ == "__main__":
    main()
