#include <memory>
#include <rclcpp/rclcpp.hpp>
#include <std_msgs/msg/bool.hpp>
#include <variant>
#include <vector>

struct Module
{
  virtual ~Module() = default;
  virtual void configure() = 0;
};

struct Color : Module
{
  explicit Color(rclcpp::Node & node) : node_(node) {}
  void configure() override { publisher_ = node_.create_publisher<std_msgs::msg::Bool>("color", 1); }
  void calibrate() { calibrated_ = node_.create_publisher<std_msgs::msg::Bool>("calibrated", 1); }

  rclcpp::Node & node_;
  rclcpp::Publisher<std_msgs::msg::Bool>::SharedPtr publisher_, calibrated_;
};

struct Depth : Module
{
  explicit Depth(rclcpp::Node & node) : node_(node) {}
  void configure() override { publisher_ = node_.create_publisher<std_msgs::msg::Bool>("depth", 1); }
  void start() { started_ = node_.create_publisher<std_msgs::msg::Bool>("started", 1); }

  rclcpp::Node & node_;
  rclcpp::Publisher<std_msgs::msg::Bool>::SharedPtr publisher_, started_;
};

class Camera : public rclcpp::Node
{
public:
  explicit Camera(int kind) : Node("camera")
  {
    if (kind == 1) {
      module_ = std::make_shared<Color>(*this);
      modules_.push_back(std::get<std::shared_ptr<Color>>(module_));
    } else if (kind == 2) {
      module_ = std::make_shared<Depth>(*this);
      modules_.push_back(std::get<std::shared_ptr<Depth>>(module_));
    }
    for (auto & module : modules_) {
      module->configure();
    }
    if (auto * depth = std::get_if<std::shared_ptr<Depth>>(&module_)) {
      (*depth)->start();
    }
    Color color(*this);
    std::variant<std::monostate, Color> single = color;
    std::visit([](auto & one) { one.calibrate(); }, single);
  }

private:
  std::variant<std::monostate, std::shared_ptr<Color>, std::shared_ptr<Depth>> module_;
  std::vector<std::shared_ptr<Module>> modules_;
};

int main(int argc, char ** argv)
{
  rclcpp::init(argc, argv);
  rclcpp::spin(std::make_shared<Camera>(std::atoi(argv[1])));
}
