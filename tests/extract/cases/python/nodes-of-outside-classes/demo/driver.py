import company.process
from company.node import CompanyNode
from std_msgs.msg import String


class Driver(CompanyNode):
    def __init__(self, **options):
        super().__init__("driver", **options)
        self.declare_parameter("rate", 10.0)
        self.state = self.create_publisher(String, "state", 1)


@company.process.main(prebaked=False)
def main():
    company.process.spin(Driver)
