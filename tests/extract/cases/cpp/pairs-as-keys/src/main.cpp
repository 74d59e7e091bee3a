#include <rclcpp/rclcpp.hpp>
#include <map>
#include <vendor/types.h>
#include <sensor_msgs/msg/image.hpp>
#include <sensor_msgs/msg/imu.hpp>
#include <std_msgs/msg/string.hpp>

using Stream = std::pair<vendor_stream, int>;
const Stream COLOR{VENDOR_STREAM_COLOR, 0};
const Stream LEFT{VENDOR_STREAM_INFRARED, 1};
const Stream RIGHT{VENDOR_STREAM_INFRARED, 2};
const Stream GYRO{VENDOR_STREAM_GYRO, 0};
const std::vector<Stream> IMAGES = {COLOR, LEFT, RIGHT};

class Camera : public rclcpp::Node {
public:
  Camera() : Node("camera") {
    names_[COLOR] = "color";
    names_[LEFT] = "left";
    names_[RIGHT] = "right";
    names_[GYRO] = "gyro";
    for (const auto& stream : IMAGES) {
      images_[stream] = create_publisher<sensor_msgs::msg::Image>(names_[stream] + "/image_raw", 10);
    }
    imu_ = create_publisher<sensor_msgs::msg::Imu>(names_[GYRO] + "/sample", 10);
  }
private:
  std::map<Stream, std::string> names_;
  std::map<Stream, rclcpp::Publisher<sensor_msgs::msg::Image>::SharedPtr> images_;
  rclcpp::Publisher<sensor_msgs::msg::Imu>::SharedPtr imu_;
};

int main(int argc, char** argv) {
  rclcpp::init(argc, argv);
  rclcpp::spin(std::make_shared<Camera>());
}
