#include <boost/algorithm/string.hpp>
#include <fstream>
#include <rclcpp/rclcpp.hpp>
#include <sensor_msgs/msg/laser_scan.hpp>
#include <sstream>
#include <std_msgs/msg/string.hpp>

class Pieces : public rclcpp::Node
{
public:
  Pieces()
  : Node("pieces")
  {
    std::stringstream fixed("left right");
    std::string side;
    while (fixed >> side) {
      pub(side);
    }

    std::istringstream set(declare_parameter("scans", "front rear"));
    std::string scan;
    while (set >> scan) {
      create_subscription<sensor_msgs::msg::LaserScan>(declare_parameter(scan + ".topic", scan), 10, nullptr);
    }

    // Nothing by default: what a launch file names is not known.
    std::stringstream empty(declare_parameter("arms", ""));
    std::string arm;
    while (std::getline(empty, arm, ',')) {
      pub(arm + "/arm");
    }

    std::vector<std::string> parts;
    boost::split(parts, "up,down", boost::is_any_of(","));
    for (const auto & part : parts) {
      pub(part);
    }

    std::string first, second;
    std::stringstream("one two") >> first >> second;
    pub(second);

    std::ifstream file("names.txt");
    std::string name;
    while (file >> name) {
      pub(name);
    }

  }

private:
  void pub(const std::string & name) {create_publisher<std_msgs::msg::String>(name, 1);}
};

int main(int argc, char ** argv)
{
  rclcpp::init(argc, argv);
  rclcpp::spin(std::make_shared<Pieces>());
}
