from std_msgs.msg import Bool

from .model import Model


class Linear(Model):
    LABEL = 'linear'

    def __init__(self, node, topic):
        super().__init__(node, topic)
        self.limit = node.create_publisher(Bool, topic + '/limit', 10)
