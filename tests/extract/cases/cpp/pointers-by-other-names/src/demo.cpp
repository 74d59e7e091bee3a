#include <ros/ros.h>
#include <std_msgs/Bool.h>

class World
{
public:
  World() { state_ = nh_.advertise<std_msgs::Bool>("world", 1); }
  ros::NodeHandle nh_;
  ros::Publisher state_;
};

using WorldPtr = World*;
typedef World* OtherWorld;

template <typename T>
struct Holder
{
  using Held = T*;
  Held held_;
};

class Part
{
public:
  Part() { pub_ = nh_.advertise<std_msgs::Bool>("part", 1); }
  void init(WorldPtr world) { world_ = world; }

private:
  ros::NodeHandle nh_;
  ros::Publisher pub_;
  WorldPtr world_;
  OtherWorld other_;
  Holder<World> holder_;
};

int main(int argc, char** argv)
{
  ros::init(argc, argv, "demo");
  Part part;
  WorldPtr none;
  ros::spin();
}
