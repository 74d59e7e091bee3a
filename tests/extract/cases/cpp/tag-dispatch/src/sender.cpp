#include <image_transport/image_transport.hpp>
#include <rclcpp/rclcpp.hpp>
#include <sensor_msgs/msg/image.hpp>
#include <std_msgs/msg/int32.hpp>
#include <std_msgs/msg/string.hpp>

template <class M>
class Sender
{
public:
  Sender(rclcpp::Node::SharedPtr node, const std::string& name) : node_(node), images_(node), name_(name)
  {
    publisher_ = advertise(std::is_same<M, sensor_msgs::msg::Image>{});
    counter_ = node_->create_publisher<std::conditional_t<std::is_same_v<M, std_msgs::msg::String>, M, std_msgs::msg::Int32>>(
      name + "/chosen", 1);
  }

private:
  std::shared_ptr<void> advertise(std::true_type)
  {
    return std::make_shared<image_transport::Publisher>(images_.advertise(name_, 1));
  }
  std::shared_ptr<void> advertise(std::false_type)
  {
    return node_->create_publisher<M>(name_, 1);
  }

  rclcpp::Node::SharedPtr node_;
  image_transport::ImageTransport images_;
  std::string name_;
  std::shared_ptr<void> publisher_, counter_;
};

int main(int argc, char** argv)
{
  rclcpp::init(argc, argv);
  auto node = rclcpp::Node::make_shared("sender");
  Sender<std_msgs::msg::String> texts(node, "texts");
  Sender<sensor_msgs::msg::Image> images(node, "images");
  rclcpp::spin(node);
}
