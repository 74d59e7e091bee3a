#include <rclcpp/rclcpp.hpp>
#include <std_msgs/msg/string.hpp>
class N : public rclcpp::Node {
  std::string name_{}, built_;
public:
  N() : Node("n") {
    vendor::read(this, fields());
    a_ = create_publisher<std_msgs::msg::String>(std::format("/{}/left", name_), 1);
    built_ += "camera";
    built_ += "/image";
    b_ = create_publisher<std_msgs::msg::String>(built_, 1);
    std::string empty = "";
    c_ = create_publisher<std_msgs::msg::String>("base" + empty + "/x", 1);
    std::string frame;
    if (frame.empty()) d_ = create_publisher<std_msgs::msg::String>("d", 1);
    else e_ = create_publisher<std_msgs::msg::String>("e", 1);
    std::string made{};
    for (const char* part : {"f", "/", "g"}) made = made + part;
    f_ = create_publisher<std_msgs::msg::String>(made, 1);
    std::stringstream stream; stream << "s" << "/t";
    g_ = create_publisher<std_msgs::msg::String>(stream.str(), 1);
    std::string local{}; 
    h_ = create_publisher<std_msgs::msg::String>(std::format("pre_{}post", local), 1);
  }
  rclcpp::PublisherBase::SharedPtr a_, b_, c_, d_, e_, f_, g_, h_;
};
int main(int argc, char** argv) { rclcpp::init(argc, argv); rclcpp::spin(std::make_shared<N>()); }
