#include <ros/ros.h>

class Settings
{
public:
  void take(const std::string & name)
  {
    int whole;
    std::string text;
    if (handle_.getParam("settings/" + name, whole)) {
      return;
    }
    handle_.getParam("settings/" + name, text);
  }

private:
  ros::NodeHandle handle_;
};

int main(int argc, char ** argv)
{
  ros::init(argc, argv, "settings");
  Settings settings;
  settings.take("method");
  ros::NodeHandle handle;
  int steps;
  double length;
  handle.getParam("steps", steps);
  handle.getParam("steps", length);
}
