#include <deque>

#include <rclcpp/rclcpp.hpp>
#include <std_msgs/msg/bool.hpp>

// Only what it stores decides whether the timer goes on.
class Buffer
{
public:
  void add(const std_msgs::msg::Bool & one)
  {
    held_.push_front(one);
    while (held_.size() > 10) {
      held_.pop_back();
    }
  }
  bool empty() const {return held_.empty();}

private:
  std::deque<std_msgs::msg::Bool> held_;
};

class GateKeeper : public rclcpp::Node
{
public:
  GateKeeper()
  : Node("gate_keeper")
  {
    opened_ = create_subscription<std_msgs::msg::Bool>(
      "opened", 1, [this](std_msgs::msg::Bool::ConstSharedPtr message) {onOpened(*message);});
    seen_ = create_subscription<std_msgs::msg::Bool>(
      "seen", 1, [this](std_msgs::msg::Bool::ConstSharedPtr message) {buffer_.add(*message);});
    timer_ = create_wall_timer(std::chrono::seconds(1), std::bind(&GateKeeper::onTimer, this));
  }

private:
  void onOpened(const std_msgs::msg::Bool & message)
  {
    open_ = true;
    last_ = std::make_shared<std_msgs::msg::Bool>(message);
  }

  void onTimer()
  {
    if (!open_ || last_ == nullptr || buffer_.empty()) {
      return;
    }
    if (!passed_) {
      passed_ = create_publisher<std_msgs::msg::Bool>("passed", 1);
    }
  }

  bool open_ = false;
  Buffer buffer_;
  std::shared_ptr<std_msgs::msg::Bool> last_ = nullptr;
  rclcpp::Subscription<std_msgs::msg::Bool>::SharedPtr opened_;
  rclcpp::Subscription<std_msgs::msg::Bool>::SharedPtr seen_;
  rclcpp::Publisher<std_msgs::msg::Bool>::SharedPtr passed_;
  rclcpp::TimerBase::SharedPtr timer_;
};

int main(int argc, char ** argv)
{
  rclcpp::init(argc, argv);
  rclcpp::spin(std::make_shared<GateKeeper>());
  rclcpp::shutdown();
}
