import abc

import rospy


class Transport(rospy.SubscribeListener):
    __metaclass__ = abc.ABCMeta

    def __init__(self):
        rospy.get_param("~always", False)

    def advertise(self, *args, **kwargs):
        self.subscribe()
        return rospy.Publisher(*args, **kwargs)

    @abc.abstractmethod
    def subscribe(self):
        raise NotImplementedError
