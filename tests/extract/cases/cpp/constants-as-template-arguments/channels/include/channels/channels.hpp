#pragma once

#include <rclcpp/rclcpp.hpp>

namespace house {

template <const char* Name, typename Message>
struct Channel {
  static constexpr const char* kName = Name;
  using Content = Message;
};

#define CHANNEL(channel, topic, type)                 \
  inline constexpr char channel##_topic[] = topic;    \
  using channel = house::Channel<channel##_topic, type>;

template <const char* Name>
class Lamp : public rclcpp::Node {
 public:
  Lamp() : rclcpp::Node(Name) {}

  template <typename C, typename F>
  void listen(F&& callback) {
    const std::string name = C::kName;
    inputs_[name] = this->create_subscription<typename C::Content>(name, 10, std::forward<F>(callback));
  }

  template <typename C>
  auto output() {
    return this->create_publisher<typename C::Content>(C::kName, 10);
  }

 private:
  std::map<std::string, rclcpp::SubscriptionBase::SharedPtr> inputs_;
};

}  // namespace house
