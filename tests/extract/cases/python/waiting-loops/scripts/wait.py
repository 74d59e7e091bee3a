#!/usr/bin/env python
import rospy
from fleet import ask
from std_msgs.msg import String


def status_of(asked, kind, number):
    """Report to a topic of each kind that is named."""
    status = 'unknown'
    while status != 'active':
        rospy.loginfo('%s: %s of %s (%s)', 'robot' + str(number), asked + '/' + kind, 'system' + kind, [1, 2, 3, number])
        rospy.loginfo('%s: %s of %s (%s)', 'arm' + str(number), asked + '/' + kind, 'system' + kind, [1, 2, 3, number])
        rospy.sleep(0.5)
        answer = ask(asked)
        if answer is not None:
            status = answer.status
    if kind:
        rospy.Publisher('status/' + kind, String, queue_size=1)


rospy.init_node('wait')
for each in range(3):
    status_of('asked', '', each)
status_of('asked', 'arm', 4)

# A loop that collects values is not one that waits.
names = []
left = ['a', 'b', 'c', 'd', 'e', 'f']
while left:
    names.append('topic_' + left.pop(0))
for name in names:
    rospy.Subscriber(name, String, print)


class Counter:
    """Counts in a field, and publishes late."""

    def __init__(self):
        self.count = 0
        while self.count < 9:
            if self.count == 7:
                rospy.Publisher('seventh', String, queue_size=1)
            self.count += 1


Counter()
