#include <algorithm>
#include <cctype>
#include <string>

#include <ros/ros.h>
#include <std_msgs/String.h>

std::string by_transform(const std::string & text)
{
  std::string result = text;
  std::transform(result.begin(), result.end(), result.begin(), ::tolower);
  return result;
}

std::string by_lambda(const std::string & text)
{
  std::string result;
  std::transform(text.begin(), text.end(), std::back_inserter(result),
    [](unsigned char letter) { return static_cast<char>(std::toupper(letter)); });
  return result;
}

std::string by_loop(std::string text)
{
  for (char & letter : text) {
    if (letter == '/') {
      letter = '_';
    }
  }
  return text;
}

std::string letter_by_letter(const std::string & text)
{
  std::string result;
  for (char letter : text) {
    result.push_back(std::tolower(letter));
  }
  return result;
}

int main(int argc, char ** argv)
{
  ros::init(argc, argv, "sender");
  ros::NodeHandle node;
  ros::Publisher publishers[20];
  int count = 0;
  for (int index = 0; index < 2; ++index) {
    std::string digit = "0";
    digit[0] += index;
    publishers[count++] = node.advertise<std_msgs::String>("digit_" + digit, 1);
    std::string name = "axis_";
    name += 'x' + index;
    publishers[count++] = node.advertise<std_msgs::String>(name, 1);
    char side = 'A' + index + 0;
    publishers[count++] = node.advertise<std_msgs::String>(std::string("side_") + side, 1);
  }
  int place = 'c' - 'a';
  publishers[count++] = node.advertise<std_msgs::String>("place_" + std::to_string(place), 1);
  publishers[count++] = node.advertise<std_msgs::String>(by_transform("Left_Arm"), 1);
  publishers[count++] = node.advertise<std_msgs::String>(by_lambda("left"), 1);
  publishers[count++] = node.advertise<std_msgs::String>(by_loop("arm/state"), 1);
  publishers[count++] = node.advertise<std_msgs::String>(letter_by_letter("RIGHT"), 1);
  publishers[count++] = node.advertise<std_msgs::String>(by_transform("Of_" + std::string(argv[1])), 1);
  std::string given = argv[2];
  given[1] = '_';
  publishers[count++] = node.advertise<std_msgs::String>("given/" + given, 1);
  std::vector<std::string> joints = {"hip", "knee"}, topics(2);
  std::transform(joints.begin(), joints.end(), topics.begin(), [](const std::string & joint) { return joint + "/state"; });
  for (const auto & topic : topics) {
    publishers[count++] = node.advertise<std_msgs::String>(topic, 1);
  }
  ros::spin();
}
