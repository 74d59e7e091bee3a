#include <image_transport/image_transport.hpp>
#include <rclcpp/rclcpp.hpp>
#include <message_filters/subscriber.h>
#include <sensor_msgs/msg/imu.hpp>
int main(int argc, char ** argv)
{
  rclcpp::init(argc, argv);
  auto node = rclcpp::Node::make_shared("viewer");
  image_transport::ImageTransport it(node);
  auto pub = it.advertise("out_image", 1);
  auto sub = it.subscribe("in_image", 1, callback);
  message_filters::Subscriber<sensor_msgs::msg::Imu> imu(node, "imu");
  rclcpp::spin(node);
}
