#include <ros/ros.h>
#include <std_msgs/String.h>
#include <topic_tools/shape_shifter.h>
#include <string>
#include <vector>

ros::NodeHandle* node = nullptr;
ros::Publisher output;
std::string output_topic;
std::string fallback = "fallback";

void received(const boost::shared_ptr<topic_tools::ShapeShifter const>& message)
{
  output = message->advertise(*node, output_topic, 10);
}

void play(const std::string& file)
{
  ros::Publisher played = node->advertise<std_msgs::String>("played", 1);
}

int main(int argc, char** argv)
{
  std::vector<std::string> args;
  ros::removeROSArgs(argc, argv, args);
  ros::init(argc, argv, "relay", ros::init_options::AnonymousName);
  ros::NodeHandle nh;
  node = &nh;
  if (argc == 2)
    output_topic = std::string(argv[1]) + std::string("_relay");
  else
    output_topic = std::string(argv[2]);
  if (argc > 3)
    fallback = argv[3];
  ros::Subscriber input = nh.subscribe(args[1], 10, received);
  ros::Publisher state = nh.advertise<std_msgs::String>(fallback, 1);
  if (argc == 1)
  {
    ros::spin();
  }
  else if ((argc >= 4) && (std::string(argv[1]) == "--play"))
  {
    play(argv[2]);
  }
  return 0;
}
