#include <cstdlib>
#include <ros/ros.h>
#include <sstream>
#include <std_msgs/String.h>
#include <outside/robot.h>

using M = std_msgs::String;

class Talker
{
public:
  Talker(const outside::Config& config) : prefix_(config.prefix) {}

  void start(ros::NodeHandle& nh, const std::string& name)
  {
    member_ = nh.advertise<M>(prefix_ + "/member", 1);
    argument_ = nh.advertise<M>("argument/" + name, 1);
  }

private:
  std::string prefix_;
  ros::Publisher member_, argument_;
};

int main(int argc, char** argv)
{
  ros::init(argc, argv, outside::chosenName());
  ros::NodeHandle nh, pnh("~");
  std::vector<ros::Publisher> all;

  std::string frame;
  pnh.getParam("frame_prefix", frame);
  all.push_back(nh.advertise<M>(frame + "odom", 1));
  all.push_back(nh.advertise<M>(std::string("camera/") + argv[1], 1));

  std::string robot = outside::robotName(3);
  all.push_back(nh.advertise<M>(robot + "/variable", 1));
  all.push_back(nh.advertise<M>(robot + "/twice/" + robot, 1));
  all.push_back(nh.advertise<M>(outside::modelName() + "/function", 1));
  all.push_back(nh.advertise<M>(outside::modelName("a") + outside::modelName("b") + "/calls", 1));
  std::string first = outside::robotName(1), second = outside::robotName(2);
  all.push_back(nh.advertise<M>(first + second + "/neighbours", 1));
  all.push_back(nh.advertise<M>(std::string(getenv("ROBOT_TYPE")) + "/environment", 1));

  std::stringstream words(outside::line("config"));
  std::string word;
  while (words >> word)
  {
    all.push_back(nh.advertise<M>("word/" + word, 1));
  }
  std::string item;
  while (std::getline(words, item, ','))
  {
    all.push_back(nh.advertise<M>("line/" + item, 1));
  }
  for (int i = 0; i < argc; i++)
  {
    all.push_back(nh.advertise<M>("counted" + std::to_string(i), 1));
  }
  all.push_back(nh.advertise<M>(ros::this_node::getName() + "_action", 1));
  all.push_back(nh.advertise<M>("/robots" + ros::this_node::getNamespace() + "/state", 1));
  pnh.getParam(ros::this_node::getName() + "/rate", argc);

  Talker talker(outside::configuration());
  talker.start(nh, robot);
  ros::spin();
}
