#include <framework/controller.h>
#include <framework/singleton.h>
#include <ros/ros.h>
#include <std_msgs/Bool.h>

// The controller, the module and the singleton are in a library outside of the sources.
class Walk : public framework::Module, public framework::Singleton<Walk>
{
public:
  Walk() {}

  void initialize(int cycle)
  {
    ros::NodeHandle nh;
    state_ = nh.advertise<std_msgs::Bool>("walk/state", 1);
    start_ = nh.subscribe("walk/start", 1, &Walk::on_start, this);
  }

private:
  void on_start(const std_msgs::Bool &) {}
  void never() { hidden_ = ros::NodeHandle().advertise<std_msgs::Bool>("walk/never", 1); }

  ros::Publisher state_, hidden_;
  ros::Subscriber start_;
};

class Look : public framework::Module
{
public:
  void initialize(int cycle) override { state_ = ros::NodeHandle().advertise<std_msgs::Bool>("look/state", 1); }
  void debug() { debug_ = ros::NodeHandle().advertise<std_msgs::Bool>("look/debug", 1); }

private:
  ros::Publisher state_, debug_;
};

// Nothing outside can call methods of a class whose bases only add to it.
class Settings : public std::enable_shared_from_this<Settings>
{
public:
  void show() { shown_ = ros::NodeHandle().advertise<std_msgs::Bool>("settings", 1); }

private:
  ros::Publisher shown_;
};

int main(int argc, char ** argv)
{
  ros::init(argc, argv, "robot");
  framework::Controller * controller = framework::Controller::getInstance();
  controller->add((framework::Module *)Walk::getInstance());
  Look look;
  controller->add(&look);
  Settings settings;
  controller->configure(settings);
  ros::spin();
}
