#include <ros/ros.h>
#include <geometry_msgs/Pose.h>
#include <geometry_msgs/Twist.h>
#include <nav_msgs/Path.h>
#include <sensor_msgs/Imu.h>
#include <std_msgs/Bool.h>
#include <std_msgs/Char.h>
#include <std_msgs/Float32.h>
#include <std_msgs/Float64.h>
#include <std_msgs/Int32.h>
#include <std_msgs/String.h>
#include "names.hpp"

using Text = std_msgs::String;
typedef std_msgs::Int32 Number;
using namespace sensor_msgs;
using nav_msgs::Path;
namespace geo = geometry_msgs;

struct Traits
{
  typedef geometry_msgs::Twist Message;
};

template <typename T, typename Default = std_msgs::Float32>
class Sender
{
public:
  Sender(ros::NodeHandle& nh, const std::string& name)
  {
    publisher_ = nh.advertise<typename T::Message>(name, 1);
    other_ = nh.advertise<Default>("default_argument", 1);
  }

private:
  ros::Publisher publisher_, other_;
};

template <class M>
struct Base
{
  explicit Base(ros::NodeHandle nh)
  {
    publisher = nh.advertise<M>("derived", 1);
  }
  ros::Publisher publisher;
};

struct Derived : Base<std_msgs::Float64>
{
  using Base::Base;
  typedef std_msgs::Bool Flag;
  void more(ros::NodeHandle nh)
  {
    flag = nh.advertise<Flag>("class_alias", 1);
  }
  ros::Publisher flag;
};

void received(const ImuConstPtr& message)
{
}

int main(int argc, char** argv)
{
  ros::init(argc, argv, "types");
  ros::NodeHandle nh;
  ros::Publisher a = nh.advertise<Text>("alias", 1);
  ros::Publisher b = nh.advertise<Number>("typedef", 1);
  ros::Publisher c = nh.advertise<Imu>("used", 1);
  ros::Publisher d = nh.advertise<Path>("declared", 1);
  ros::Publisher e = nh.advertise<geo::Pose>("namespace_alias", 1);
  Sender<Traits> sender(nh, "traits");
  Derived derived(nh);
  derived.more(nh);
  std_msgs::Char letter;
  ros::Publisher f = nh.advertise<decltype(letter)>("of_variable", 1);
  ros::Publisher g = nh.advertise<names::Position>("header", 1);
  ros::Publisher h = nh.advertise<Mystery>("unknown", 1);
  ros::Subscriber i = nh.subscribe("pointer", 1, received);
  ros::spin();
}
