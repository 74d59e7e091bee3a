#include <any>
#include <map>
#include <optional>
#include <variant>

#include <rclcpp/rclcpp.hpp>
#include <std_msgs/msg/string.hpp>

struct Part
{
  Part(rclcpp::Node* node, const std::string& name)
  {
    publisher = node->create_publisher<std_msgs::msg::String>(name, 1);
  }
  void start(rclcpp::Node* node)
  {
    started = node->create_publisher<std_msgs::msg::String>("started", 1);
  }
  std::shared_ptr<void> publisher, started;
};

class Sender : public rclcpp::Node
{
public:
  Sender() : Node("sender")
  {
    if (declare_parameter("with_optional", true)) {
      optional_.emplace(this, "optional");
    }
    if (optional_) {
      optional_->start(this);
    }
    variant_.emplace<Part>(this, "variant");
    any_.emplace<Part>(this, "any");
    by_name_.try_emplace("first", this, "by_name");
  }

private:
  std::optional<Part> optional_, empty_;
  std::variant<int, Part> variant_;
  std::any any_;
  std::map<std::string, Part> by_name_;
};

int main(int argc, char** argv)
{
  rclcpp::init(argc, argv);
  rclcpp::spin(std::make_shared<Sender>());
}
