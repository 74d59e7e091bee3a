#include <rclcpp/rclcpp.hpp>
#include <std_msgs/msg/string.hpp>
#include <vendor/device.hpp>

using String = std_msgs::msg::String;

// A device decides which interfaces there are; what it says is unknown.
class Driver : public rclcpp::Node {
public:
  Driver() : Node("driver") {
    if (device_.has_imu()) {
      imu_ = create_publisher<String>("imu", 10);
    } else if (device_.has_gyro()) {
      imu_ = create_publisher<String>("gyro", 10);
    } else {
      imu_ = create_publisher<String>("none", 10);
    }
    // Either way it is there.
    if (device_.is_fast()) {
      data_ = create_publisher<String>("data", 100);
    } else {
      data_ = create_publisher<String>("data", 10);
    }
    // The innermost condition says most; parameters stay.
    if (device_.has_arm() && declare_parameter("use_arm", true)) {
      if (device_.has_hand()) {
        hand_ = create_publisher<String>("hand", 10);
      }
    }
    // Who sets the name wants the interface.
    std::string topic;
    if (get_parameter("~/topic", topic) && device_.is_open()) {
      state_ = create_publisher<String>(topic, 10);
    }
    timer_ = create_wall_timer(std::chrono::seconds(1), [this] {
      // It will be ready at some time.
      if (device_.is_ready()) {
        late_ = create_publisher<String>("late", 10);
      }
    });
    if (!device_.is_open()) {
      return;
    }
    // The rest of a constructor that ends early for lack of a device is what it is for.
    open_ = create_publisher<String>("open", 10);
  }

private:
  vendor::Device device_;
  rclcpp::Publisher<String>::SharedPtr imu_, data_, hand_, state_, late_, open_;
  rclcpp::TimerBase::SharedPtr timer_;
};

int main(int argc, char** argv) {
  rclcpp::init(argc, argv);
  rclcpp::spin(std::make_shared<Driver>());
}
