#include <ros/ros.h>
#include <std_msgs/Bool.h>
#include <std_msgs/Char.h>
#include <std_msgs/Float32.h>
#include <std_msgs/Float64.h>
#include <std_msgs/Int16.h>
#include <std_msgs/Int32.h>
#include <std_msgs/Int8.h>
#include <std_msgs/String.h>

struct Settings
{
  std::string topic;
  std::string other = "from/default";
};

std::string global_topic = "unset";

void read(ros::NodeHandle& own, const std::string& name, std::string& value)
{
  own.param<std::string>(name, value, "from/output");
}

class Keeper
{
public:
  void set(const std::string& name)
  {
    name_ = name;
  }
  std::string get() const
  {
    return "from/" + kept_;
  }
  std::string name_;

private:
  std::string kept_ = "getter";
};

ros::Publisher make(ros::NodeHandle& nh, const std::string& name = "function/default")
{
  return nh.advertise<std_msgs::Int16>(name, 1);
}

int main(int argc, char** argv)
{
  ros::init(argc, argv, "initialised_elsewhere");
  ros::NodeHandle nh, own("~");
  Settings settings;
  settings.topic = "from/struct";
  ros::Publisher a = nh.advertise<std_msgs::String>(settings.topic, 1);
  ros::Publisher b = nh.advertise<std_msgs::Bool>(settings.other, 1);
  Keeper keeper;
  keeper.set("from/setter");
  ros::Publisher c = nh.advertise<std_msgs::Int32>(keeper.name_, 1);
  std::string output;
  read(own, "output", output);
  ros::Publisher d = nh.advertise<std_msgs::Char>(output, 1);
  ros::Publisher e = nh.advertise<std_msgs::Float32>(keeper.get(), 1);
  own.param<std::string>("global", global_topic, "global");
  ros::Publisher f = nh.advertise<std_msgs::Float64>(global_topic, 1);
  std::vector<ros::Publisher> more;
  auto publish = [&](const std::string& letter) { more.push_back(nh.advertise<std_msgs::Int8>("lambda/" + letter, 1)); };
  publish("a");
  publish("b");
  ros::Publisher g = make(nh);
  ros::spin();
}
