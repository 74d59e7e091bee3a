#include <ros/ros.h>
#include <std_msgs/String.h>

// What is added to a list under conditions is in it, whatever is added later; a number that the program may replace by
// one that it reads decides nothing.
ros::NodeHandle nh;

class Part
{
public:
  virtual void start() = 0;
};
typedef boost::shared_ptr<Part> PartPtr;

class Old : public Part
{
public:
  void start() { publisher = nh.advertise<std_msgs::String>("old", 1); }
  ros::Publisher publisher;
};

class New : public Part
{
public:
  void start() { publisher = nh.advertise<std_msgs::String>("new", 1); }
  ros::Publisher publisher;
};

int main(int argc, char** argv)
{
  ros::init(argc, argv, "server");
  int version = 0;
  for (int i = 0; i < argc; i++) {
    if (std::string(argv[i]).find("version") == 0) version = ::atoi(argv[i + 1]);
  }
  std::vector<PartPtr> parts;
  if (version < 14) parts.push_back(PartPtr(new Old));
  else parts.push_back(PartPtr(new New));
  for (int i = 0; i < parts.size(); i++) parts[i]->start();

  std::vector<std::string> topics;
  if (nh.hasParam("a")) topics.push_back("a");
  if (nh.hasParam("b")) topics.push_back("b");
  if (nh.hasParam("c")) topics.push_back("c");
  if (nh.hasParam("d")) topics.push_back("d");
  if (nh.hasParam("e")) topics.push_back("e");
  topics.push_back("always");
  if (nh.hasParam("f")) topics.push_back("f");
  if (nh.hasParam("g")) topics.push_back("g");
  if (nh.hasParam("h")) topics.push_back("h");
  if (nh.hasParam("i")) topics.push_back("i");
  if (nh.hasParam("j")) topics.push_back("j");
  if (nh.hasParam("k")) topics.push_back("k");
  if (nh.hasParam("l")) topics.push_back("l");
  if (nh.hasParam("m")) topics.push_back("m");
  for (const auto& topic : topics) nh.advertise<std_msgs::String>(topic, 1);
}
