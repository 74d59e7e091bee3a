import company.scope
from std_msgs.msg import String
from std_srvs.srv import Trigger


class Commander:
    def __init__(self, node):
        self.node = node
        self.commands = self.node.create_publisher(String, "commands", 1)
        self.stop = self.node.create_client(Trigger, "stop")


def main():
    Commander(company.scope.node())
