import rclpy
from rclpy.node import Node
from serial import Serial
from std_msgs.msg import String


class Frame:
    def __init__(self, command, data):
        self.command = command
        self.data = data


class Bridge(Node):
    def __init__(self):
        super().__init__("bridge")
        self.serial = Serial("/dev/ttyUSB0")
        self.publishers_of = {}
        self.create_timer(0.1, self.read)

    def decode(self, packet):
        packet = packet[1:-1]
        result = []
        for i in range(0, len(packet), 2):
            try:
                byte = int(packet[i : i + 2], 16)
            except ValueError:
                byte = 0
            result.append(byte)
        return Frame(result[0], result[1:])

    def read(self):
        line = self.serial.readline().decode()
        frame = self.decode(line)
        name = "frames/" + hex(frame.command)[1:]
        if name not in self.publishers_of:
            self.publishers_of[name] = self.create_publisher(String, name, 10)


def main():
    rclpy.init()
    rclpy.spin(Bridge())
