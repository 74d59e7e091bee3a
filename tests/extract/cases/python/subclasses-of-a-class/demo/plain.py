import rclpy
from rclpy.node import Node

from .models import Model


class Chooser(Node):
    def __init__(self):
        super().__init__('chooser')
        self.one = Model.create('plain', self, 'fixed')
        self.two = Model.create(self.declare_parameter('model', 'linear').value, self, 'chosen')


def main():
    rclpy.init()
    rclpy.spin(Chooser())
