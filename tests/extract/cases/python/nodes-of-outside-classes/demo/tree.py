import rclpy
from anytree import Node

from company.names import DRIVERS


class Part(Node):
    pass


class Hub:
    def create_client(self, kind, name):
        return kind, name


def main():
    Part("root")
    Hub().create_client("first", "second")
    company_client = DRIVERS.create_client("first", "second")
    print(rclpy, company_client)
