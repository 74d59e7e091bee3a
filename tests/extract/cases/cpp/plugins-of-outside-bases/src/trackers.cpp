#include <flight_managers/tracker.h>
#include <pluginlib/class_list_macros.h>
#include <ros/ros.h>
#include <std_msgs/Bool.h>
#include <std_srvs/Trigger.h>

namespace trackers
{
// The base is not in the sources: its public methods may override, its private ones are for the class itself.
class LineTracker : public flight_managers::Tracker
{
public:
  bool initialize(const ros::NodeHandle& parent, const Settings& settings);
  void deactivate() {}

private:
  bool stop(std_srvs::Trigger::Request& request, std_srvs::Trigger::Response& response) { return true; }
  void record() { recorded_ = nh_.advertise<std_msgs::Bool>("recorded", 1); }

  ros::NodeHandle nh_;
  ros::ServiceServer stop_;
  ros::Publisher recorded_;
};

bool LineTracker::initialize(const ros::NodeHandle& parent, const Settings& settings)
{
  nh_ = ros::NodeHandle("~");
  stop_ = nh_.advertiseService("stop", &LineTracker::stop, this);
  return true;
}
}  // namespace trackers

PLUGINLIB_EXPORT_CLASS(trackers::LineTracker, flight_managers::Tracker)
