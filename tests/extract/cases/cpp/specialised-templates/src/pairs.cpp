#include <rclcpp/rclcpp.hpp>
#include <std_msgs/msg/bool.hpp>
#include <std_msgs/msg/int32.hpp>
#include <std_msgs/msg/string.hpp>

enum class Side { left, right };

template <typename First, typename Second>
struct Pair {};

template <typename T>
std::string name_of();

template <>
std::string name_of<int>()
{
  return "number";
}

template <>
std::string name_of<bool>()
{
  return "flag";
}

template <typename T>
struct Topic
{
  using Message = std_msgs::msg::String;
  static std::string name() { return "plain"; }
};

template <typename T>
struct Topic<T *>
{
  using Message = typename Topic<T>::Message;
  static std::string name() { return "pointer_to_" + Topic<T>::name(); }
};

template <typename T>
struct Topic<Pair<T, bool>>
{
  using Message = std_msgs::msg::Bool;
  static std::string name() { return name_of<T>() + "_with_flag"; }
};

template <>
struct Topic<Pair<int, bool>>
{
  using Message = std_msgs::msg::Int32;
  static std::string name() { return "exactly"; }
};

template <Side side>
struct Hand
{
  static const char * const topic;
};

template <>
const char * const Hand<Side::left>::topic = "left";

template <>
const char * const Hand<Side::right>::topic = "right";

template <int count>
struct Times
{
  static std::string name() { return "many"; }
};

template <>
struct Times<1>
{
  static std::string name() { return "once"; }
};

template <typename... T>
struct Joined;

template <typename Last>
struct Joined<Last>
{
  static std::string name() { return name_of<Last>(); }
};

template <typename First, typename Second, typename... Rest>
struct Joined<First, Second, Rest...>
{
  static std::string name() { return name_of<First>() + "/" + Joined<Second, Rest...>::name(); }
};

template <typename T>
void publish(const rclcpp::Node::SharedPtr & node)
{
  node->create_publisher<typename Topic<T>::Message>(Topic<T>::name(), 1);
}

int main(int argc, char ** argv)
{
  rclcpp::init(argc, argv);
  auto node = rclcpp::Node::make_shared("pairs");
  publish<double>(node);
  publish<double *>(node);
  publish<Pair<bool, bool>>(node);
  publish<Pair<int, bool>>(node);
  node->create_publisher<std_msgs::msg::Bool>(Hand<Side::left>::topic, 1);
  node->create_publisher<std_msgs::msg::Bool>(Hand<Side::right>::topic, 1);
  node->create_publisher<std_msgs::msg::Bool>(Times<1>::name(), 1);
  node->create_publisher<std_msgs::msg::Bool>(Times<2>::name(), 1);
  node->create_publisher<std_msgs::msg::Bool>(Topic<Elsewhere>::name(), 1);
  node->create_publisher<std_msgs::msg::Bool>(Joined<int>::name(), 1);
  node->create_publisher<std_msgs::msg::Bool>(Joined<int, bool, int>::name(), 1);
  rclcpp::spin(node);
}
