#include <rclcpp_lifecycle/lifecycle_node.hpp>
#include <std_msgs/msg/string.hpp>
#include <vendor/device.hpp>

using String = std_msgs::msg::String;

// The framework runs transitions once, so their conditions say as much as those of a constructor.
class Driver : public rclcpp_lifecycle::LifecycleNode {
public:
  Driver() : LifecycleNode("driver") {}

  CallbackReturn on_configure(const rclcpp_lifecycle::State&) override {
    if (device_.has_imu()) {
      imu_ = create_publisher<String>("imu", 10);
    }
    data_ = create_publisher<String>("data", 10);
    orders_ = create_subscription<String>("orders", 10, [this](const String& order) {
      // Some message will ask for it.
      if (order.data == "report") {
        report_ = create_publisher<String>("report", 10);
      }
    });
    return CallbackReturn::SUCCESS;
  }

private:
  vendor::Device device_;
  rclcpp::Publisher<String>::SharedPtr imu_, data_, report_;
  rclcpp::Subscription<String>::SharedPtr orders_;
};

int main(int argc, char** argv) {
  rclcpp::init(argc, argv);
  rclcpp::spin(std::make_shared<Driver>()->get_node_base_interface());
}
