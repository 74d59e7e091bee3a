#!/usr/bin/env python
# Writes down what passes on a topic, for the rovers that still run Python 2:
#   rosrun rover_robot topic_logger.py /some/topic

import sys

import rospy
from diagnostic_msgs.msg import DiagnosticArray
from std_msgs.msg import String, UInt32

count = 0


def on_message(msg):
    global count
    count += 1
    print >> sys.stderr, "%6d %s" % (count, msg.data)


def on_diagnostics(msg):
    for status in msg.status:
        print status.name, status.message


if __name__ == "__main__":
    rospy.init_node("topic_logger", anonymous=True)
    pub = rospy.Publisher("logged_messages", UInt32, queue_size=1)
    try:
        rospy.Subscriber(sys.argv[1], String, on_message)
    except IndexError, error:
        print "which topic?", error
        sys.exit(2)
    rospy.Subscriber("/diagnostics_agg", DiagnosticArray, on_diagnostics)
    rate = rospy.Rate(rospy.get_param("~rate", 1))
    while not rospy.is_shutdown():
        pub.publish(count)
        rate.sleep()
