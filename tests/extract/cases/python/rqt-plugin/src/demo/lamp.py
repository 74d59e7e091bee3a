import rospy
from rqt_gui_py.plugin import Plugin
from std_msgs.msg import Bool


class Lamp(Plugin):
    def __init__(self, context):
        super(Lamp, self).__init__(context)
        self.sub = rospy.Subscriber("lamp", Bool, self.show)

    def show(self, message):
        pass

    def shutdown_plugin(self):
        rospy.Publisher("bye", Bool, queue_size=1)
