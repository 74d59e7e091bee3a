#!/usr/bin/env python
import curses

import rospy
from std_msgs.msg import String


class Monitor:
    def __init__(self, screen):
        self.screen = screen
        self.watched = rospy.Subscriber("watched", String, self.on_text)

    def on_text(self, message):
        self.screen.addstr(1, 1, message.data)


def show(screen):
    rospy.Subscriber("shown", String, lambda message: screen.addstr(2, 1, message.data))


if __name__ == "__main__":
    rospy.init_node("monitor")
    curses.wrapper(Monitor)
    curses.wrapper(show)
