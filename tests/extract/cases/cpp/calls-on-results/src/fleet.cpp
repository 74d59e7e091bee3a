#include <rclcpp/rclcpp.hpp>
#include <std_msgs/msg/bool.hpp>

std::vector<std::string> names(const std::vector<std::string>& boats, const std::string& prefix, const std::string& end) {
  std::vector<std::string> all;
  for (const std::string& boat : boats) {
    std::string name;
    name.reserve(80);
    name.append(prefix).append(boat).append(end);
    all.push_back(std::move(name));
  }
  return all;
}

class Fleet : public rclcpp::Node {
 public:
  Fleet() : Node("fleet") {
    for (const auto& name : names({"ada", "bea"}, "boats/", "/ready")) {
      ready_.push_back(create_publisher<std_msgs::msg::Bool>(name, 1));
    }
    std::string stop = "boats";
    stop.append("/all").assign(stop + "/stop");
    stop_ = create_publisher<std_msgs::msg::Bool>(stop, 1);
  }

 private:
  std::vector<rclcpp::Publisher<std_msgs::msg::Bool>::SharedPtr> ready_;
  rclcpp::Publisher<std_msgs::msg::Bool>::SharedPtr stop_;
};

int main(int argc, char** argv) {
  rclcpp::init(argc, argv);
  rclcpp::spin(std::make_shared<Fleet>());
}
