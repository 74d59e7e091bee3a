#include <algorithm>

#include <boost/algorithm/string.hpp>
#include <rclcpp/rclcpp.hpp>
#include <std_msgs/msg/string.hpp>

using std_msgs::msg::String;

class Topics : public rclcpp::Node
{
public:
  Topics() : Node("topics")
  {
    std::string frame = "base/link";
    std::replace(frame.begin(), frame.end(), '/', '_');
    create_publisher<String>(frame, 1);
    boost::replace_all(frame, "base", "arm");
    boost::algorithm::to_upper(frame);
    create_publisher<String>(frame, 1);
    std::string first, second;
    std::tie(first, second) = std::make_pair(std::string("one"), std::string("two"));
    create_publisher<String>(first, 1);
    create_publisher<String>(second, 1);
    std::vector<std::pair<std::string, int>> wanted;
    wanted.emplace_back("three", 3);
    wanted.push_back({"four", 4});
    for (const auto & [name, depth] : wanted) {
      create_publisher<String>(name, depth);
    }
    const char * names[] = {"five", "six"};
    std::for_each(std::begin(names), std::end(names), [this](auto name) { create_publisher<String>(name, 1); });
  }
};

int main(int argc, char ** argv)
{
  rclcpp::init(argc, argv);
  rclcpp::spin(std::make_shared<Topics>());
}
