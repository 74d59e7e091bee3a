#include <cctype>
#include <memory>
#include <string>

#include <rclcpp/rclcpp.hpp>
#include <std_msgs/msg/string.hpp>

std::string with_underscores(const std::string & words)
{
  std::string result = std::string{static_cast<char>(std::tolower(words.at(0)))};
  for (std::size_t i = 1; i < words.size(); ++i) {
    const auto letter = words.at(i);
    if (std::isupper(letter)) {
      result += "_" + std::string{static_cast<char>(std::tolower(letter))};
    } else {
      result += letter;
    }
  }
  return result;
}

std::string with_slashes(const std::string & words)
{
  std::string result;
  for (const char letter : words) {
    if (isupper(letter) && !result.empty()) {
      result += '/';
    }
    result += tolower(letter);
  }
  return result;
}

std::string without_signs(const std::string & words)
{
  std::string result;
  for (const char letter : words) {
    result.push_back(std::isalnum(static_cast<unsigned char>(letter)) ? letter : '_');
  }
  return result;
}

class Speller : public rclcpp::Node
{
public:
  Speller() : Node("speller")
  {
    first_ = create_publisher<std_msgs::msg::String>(with_underscores("LeftSideDoor"), 1);
    second_ = create_publisher<std_msgs::msg::String>(with_slashes("LeftSideDoor"), 1);
    third_ = create_publisher<std_msgs::msg::String>(without_signs("left-side door2"), 1);
  }

private:
  rclcpp::Publisher<std_msgs::msg::String>::SharedPtr first_, second_, third_;
};

int main(int argc, char ** argv)
{
  rclcpp::init(argc, argv);
  rclcpp::spin(std::make_shared<Speller>());
  rclcpp::shutdown();
  return 0;
}
