#include <map>
#include <string>

#include <geometry_msgs/msg/point.hpp>
#include <rclcpp/rclcpp.hpp>
#include <std_msgs/msg/float64.hpp>

// Fills a list of names for its caller.
bool measure(std::map<std::string, double> & times)
{
  times["load"] = 0.0;
  times["plan"] = 0.0;
  return true;
}

// Fills a number for its caller.
void count(int & robots)
{
  robots = robots + 1;
}

class FleetReport : public rclcpp::Node
{
public:
  FleetReport()
  : Node("fleet_report")
  {
    points_ = create_subscription<geometry_msgs::msg::Point>(
      "points", 1, [this](geometry_msgs::msg::Point::ConstSharedPtr point) {onPoint(*point);});
  }

private:
  void onPoint(const geometry_msgs::msg::Point & point)
  {
    int robots = 0;
    count(robots);
    if (robots == 0) {
      spare_ = create_publisher<std_msgs::msg::Float64>("spare", 1);
    }
    choose();
    watch(point);
    if (distance(point) > 1.0 && watched_) {
      far_ = create_publisher<std_msgs::msg::Float64>("far/" + name_, 1);
    }
    const auto suffix = [](int index) {return index > 0 ? "near" : "nearest";};
    near_ = create_publisher<std_msgs::msg::Float64>(suffix(0), 1);
    std::map<std::string, double> times;
    if (measure(times)) {
      for (const auto & [topic, seconds] : times) {
        report_ = create_publisher<std_msgs::msg::Float64>("times/" + topic, 1);
      }
    }
  }

  double distance(const geometry_msgs::msg::Point & point) {return point.x * point.x + point.y * point.y;}
  void choose() {name_ = "leader";}
  void watch(const geometry_msgs::msg::Point & point) {watched_ = point.z > 0.0;}

  std::string name_;
  bool watched_ = false;
  rclcpp::Subscription<geometry_msgs::msg::Point>::SharedPtr points_;
  rclcpp::Publisher<std_msgs::msg::Float64>::SharedPtr spare_, far_, near_, report_;
};

int main(int argc, char ** argv)
{
  rclcpp::init(argc, argv);
  rclcpp::spin(std::make_shared<FleetReport>());
  rclcpp::shutdown();
}
