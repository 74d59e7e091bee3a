#!/usr/bin/env python
import rospy
from std_msgs.msg import String, Int32


def handler_name(name):
    return "fill_from_%s" % (name.replace(" ", "_"))


class Driver(object):
    def __init__(self, device):
        rospy.init_node('driver')
        self.device = device
        self.imu = None
        self.gps = None

    def do_start(self, args):
        self.start_pub = rospy.Publisher('started', String, queue_size=1)

    def do_stop(self, args):
        self.stop_pub = rospy.Publisher('stopped', String, queue_size=1)

    def unrelated(self, args):
        self.x = rospy.Publisher('wrong', String, queue_size=1)

    def command(self, text):
        getattr(self, 'do_' + text)([])
        handler = getattr(self, 'do_%s' % text, None)
        if handler:
            handler([])

    def spin_once(self):
        def fill_from_Imu(o):
            if self.imu is None:
                self.imu = rospy.Publisher('imu', String, queue_size=1)

        def fill_from_Gps(o):
            if self.gps is None:
                self.gps = rospy.Publisher('gps', Int32, queue_size=1)

        def other(o):
            rospy.Publisher('other', Int32, queue_size=1)

        data = self.device.read()
        for n, o in data.items():
            try:
                locals()[handler_name(n)](o)
            except KeyError:
                rospy.logwarn("unknown")
        self.command(data.name)

    def spin(self):
        while not rospy.is_shutdown():
            self.spin_once()


def main():
    import serial
    Driver(serial.Serial('/dev/tty')).spin()


if __name__ == '__main__':
    main()
