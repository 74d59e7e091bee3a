// Parameters are read into the fields of a message, also by a template and by a macro.
#include <gauge_msgs/Scale.h>
#include <ros/ros.h>

#define READ(name, field) if (!handle.getParam(name, field)) { ROS_WARN("no %s", name); }

template <typename T>
bool load(ros::NodeHandle & handle, const std::string & name, T & value)
{
  return handle.getParam(name, value);
}

class Gauge
{
public:
  Gauge()
  {
    load(handle, "unit", scale_.unit);
    load(handle, "marks", scale_.marks);
    handle.getParam("length", scale_.needle.length);
    READ("logarithmic", scale_.logarithmic)
    READ("offset", offset_)
    READ("strange", scale_.strange)
  }

private:
  ros::NodeHandle handle{"~"};
  gauge_msgs::Scale scale_;
  double offset_;
};

int main(int argc, char ** argv)
{
  ros::init(argc, argv, "gauge");
  Gauge gauge;
  ros::spin();
}
