#include <mapping/extension.hpp>
#include <rclcpp/rclcpp.hpp>
#include <sensor_msgs/msg/image.hpp>
#include <sensor_msgs/msg/point_cloud2.hpp>

namespace mapping {

class Viewer : public Extension {
 public:
  void start(rclcpp::Node& node) override {
    map_ = node.create_publisher<sensor_msgs::msg::PointCloud2>("~/map", 1);
  }

 private:
  rclcpp::Publisher<sensor_msgs::msg::PointCloud2>::SharedPtr map_;
};

class Recorder : public Extension {
 public:
  void start(rclcpp::Node& node) override {
    image_ = node.create_publisher<sensor_msgs::msg::Image>("~/image", 1);
  }

 private:
  rclcpp::Publisher<sensor_msgs::msg::Image>::SharedPtr image_;
};

}  // namespace mapping

extern "C" mapping::Extension* create_extension() {
  return new mapping::Viewer();
}

extern "C" {
MAPPING_EXPORT mapping::Extension* create_recorder(void) { return new mapping::Recorder; }
}
