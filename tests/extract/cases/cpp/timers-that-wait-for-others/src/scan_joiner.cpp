#include <algorithm>
#include <list>
#include <memory>

#include <rclcpp/rclcpp.hpp>
#include <sensor_msgs/msg/laser_scan.hpp>

using sensor_msgs::msg::LaserScan;

class Pair
{
public:
  explicit Pair(rclcpp::Node * node)
  : node_(node)
  {
    timer_ = node->create_wall_timer(std::chrono::seconds(1), [this]() {join();});
  }

  void add(LaserScan::ConstSharedPtr scan) {scan_ = scan;}

private:
  void join()
  {
    if (!scan_) {
      return;
    }
    publisher_ = node_->create_publisher<LaserScan>("joined", 1);
  }

  rclcpp::Node * node_;
  LaserScan::ConstSharedPtr scan_ = nullptr;
  rclcpp::Publisher<LaserScan>::SharedPtr publisher_;
  rclcpp::TimerBase::SharedPtr timer_;
};

class ScanJoiner : public rclcpp::Node
{
public:
  ScanJoiner()
  : Node("scan_joiner")
  {
    pairs_.push_back(std::make_shared<Pair>(this));
    scans_ = create_subscription<LaserScan>(
      "scan", 1, [this](LaserScan::ConstSharedPtr scan) {
        const auto oldest = *std::min_element(pairs_.begin(), pairs_.end());
        oldest->add(scan);
      });
  }

private:
  std::list<std::shared_ptr<Pair>> pairs_;
  rclcpp::Subscription<LaserScan>::SharedPtr scans_;
};

int main(int argc, char ** argv)
{
  rclcpp::init(argc, argv);
  rclcpp::spin(std::make_shared<ScanJoiner>());
  rclcpp::shutdown();
}
