#include <ros/ros.h>
#include <topic_tools/shape_shifter.h>

void heard(const topic_tools::ShapeShifter::ConstPtr& message) {}

int main(int argc, char** argv)
{
  ros::init(argc, argv, "proxy");
  ros::NodeHandle handle("~");
  std::string oven, kind;
  if (!handle.getParam("oven", oven) || !handle.getParam("kind", kind))
    return 1;
  ros::Publisher order, bell;
  ros::Subscriber done;
  {
    ros::AdvertiseOptions options;
    options.topic = oven + "/order";
    options.datatype = kind;
    order = handle.advertise(options);

    ros::SubscribeOptions listening;
    listening.init<topic_tools::ShapeShifter>(oven + "/done", 10, boost::bind(&heard, _1));
    listening.datatype = "std_msgs/Empty";
    done = handle.subscribe(listening);
  }
  {
    ros::AdvertiseOptions options;
    options.topic = "bell";
    options.datatype = "std_msgs/String";
    bell = handle.advertise(options);
  }
  ros::spin();
}
