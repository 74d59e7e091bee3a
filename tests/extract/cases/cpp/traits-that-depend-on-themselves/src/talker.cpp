#include <rclcpp/rclcpp.hpp>
#include <std_msgs/msg/string.hpp>

template <typename T, class Enable = void>
struct Traits {static const int type = 0;};

template <>
struct Traits<int> {static const int type = 1;};

template <typename T>
struct Traits<std::vector<T>, typename std::enable_if<Traits<T>::type != 0>::type>
{
  static const int type = 2;
};

template <typename T>
struct Traits<std::map<std::string, T>, typename std::enable_if<Traits<T>::type != 0>::type>
{
  static const int type = 3;
};

template <typename T>
std::string topic() {return Traits<T>::type != 0 ? "known" : "unknown";}

int main(int argc, char ** argv)
{
  rclcpp::init(argc, argv);
  auto node = std::make_shared<rclcpp::Node>("talker");
  topic<std::map<std::string, std::vector<std::vector<int>>>>();
  auto number = node->create_publisher<std_msgs::msg::String>(topic<int>(), 1);
  rclcpp::spin(node);
}
