#include <memory>
#include <string>
#include <tuple>
#include <unordered_set>
#include <vector>

#include <rclcpp/rclcpp.hpp>
#include <sensor_msgs/msg/image.hpp>
#include <sensor_msgs/msg/imu.hpp>
#include <std_msgs/msg/bool.hpp>
#include <std_msgs/msg/string.hpp>

/// Subscribes to one topic for each message type.
template <typename First, typename... Others>
class Gatherer
{
public:
  Gatherer(rclcpp::Node * node, const std::vector<std::string> & topics) : node_(node)
  {
    first_ = node_->create_subscription<First>(topics[0], 1, [](typename First::ConstSharedPtr) {});
    subscribe(std::vector<std::string>(topics.begin() + 1, topics.end()));
    auto last = *(topics.end() - 1);
    status_ = node_->create_publisher<std_msgs::msg::String>(last + "/status", 1);
    for (const auto & name : std::unordered_set<std::string>(topics.begin(), topics.begin() + 1)) {
      ready_ = node_->create_publisher<std_msgs::msg::Bool>(name + "/ready", 1);
    }
  }

private:
  template <std::size_t Index = 0>
  void subscribe(const std::vector<std::string> & topics)
  {
    if constexpr (Index < sizeof...(Others)) {
      using Message = std::tuple_element_t<Index, std::tuple<Others...>>;
      std::get<Index>(others_) = node_->create_subscription<Message>(
        topics[Index], 1, [](typename Message::ConstSharedPtr) {});
      subscribe<Index + 1>(topics);
    }
  }

  rclcpp::Node * node_;
  typename rclcpp::Subscription<First>::SharedPtr first_;
  std::tuple<typename rclcpp::Subscription<Others>::SharedPtr...> others_;
  rclcpp::Publisher<std_msgs::msg::String>::SharedPtr status_;
  rclcpp::Publisher<std_msgs::msg::Bool>::SharedPtr ready_;
};

class Inspector : public rclcpp::Node
{
public:
  Inspector() : Node("inspector")
  {
    const std::vector<std::string> topics{"crate", "crate/motion", "crate/label", "crate/open"};
    gatherer_ = std::make_shared<
      Gatherer<sensor_msgs::msg::Image, sensor_msgs::msg::Imu, std_msgs::msg::String, std_msgs::msg::Bool>>(
      this, topics);
  }

private:
  std::shared_ptr<
    Gatherer<sensor_msgs::msg::Image, sensor_msgs::msg::Imu, std_msgs::msg::String, std_msgs::msg::Bool>>
    gatherer_;
};

int main(int argc, char ** argv)
{
  rclcpp::init(argc, argv);
  rclcpp::spin(std::make_shared<Inspector>());
  rclcpp::shutdown();
  return 0;
}
