#include <ros/ros.h>
#include <camera/parameters.h>

class Camera
{
public:
  explicit Camera(const ros::NodeHandle & private_node) : private_node_(private_node)
  {
#define ENTRY(variable, help, type, value) \
  private_node_.param(#variable, parameters_.variable, value);
    CAMERA_PARAMETERS
#undef ENTRY

    if (!parameters_.serial.empty())
      ROS_INFO("one camera only");
    double rate;
    private_node_.getParam("rate", rate);
  }

private:
  ros::NodeHandle private_node_;
  Parameters parameters_;
};

int main(int argc, char ** argv)
{
  ros::init(argc, argv, "camera");
  Camera camera(ros::NodeHandle("~"));
  ros::spin();
  return 0;
}
