import rospy
from sensor_msgs.msg import Image


def subscribe(callback):
    return rospy.Subscriber("image", Image, callback)


if __name__ == "__main__":
    print("This file is imported.")
