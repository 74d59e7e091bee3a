#include <sensor_msgs/msg/point_cloud2.hpp>

#include "cache.hpp"

class Module {
 public:
  virtual ~Module() = default;
  virtual void run(Frame& frame) = 0;
};

class Filter : public Module {
 public:
  void run(Frame& frame) override {
    if (!publisher_) publisher_ = frame.node->create_publisher<sensor_msgs::msg::PointCloud2>("filtered", 5);
  }

 private:
  rclcpp::Publisher<sensor_msgs::msg::PointCloud2>::SharedPtr publisher_;
};

class Driver : public Module {
 public:
  Driver() { own_.node = std::make_shared<rclcpp::Node>("driver"); }
  void run(Frame&) override {
    publisher_ = own_.node->create_publisher<sensor_msgs::msg::PointCloud2>("raw", 5);
  }

 private:
  Frame own_;
  rclcpp::Publisher<sensor_msgs::msg::PointCloud2>::SharedPtr publisher_;
};
