#include <ros/ros.h>
#include <geometry_msgs/Pose.h>
#include <geometry_msgs/Twist.h>
#include <sensor_msgs/Image.h>
#include <std_msgs/Bool.h>
#include <std_msgs/Int32.h>
#include <std_msgs/Int64.h>

ros::Publisher image(ros::NodeHandle& nh, const std::string& side, const char* kind)
{
  return nh.advertise<sensor_msgs::Image>(side + "/" + kind, 1);
}

class Wheel
{
public:
  Wheel(const std::string& where, const std::string& what) : where_(where), what_(what)
  {
    publisher_ = nh_.advertise<std_msgs::Bool>(where_ + "/" + what_, 1);
  }

private:
  ros::NodeHandle nh_;
  std::string where_, what_;
  ros::Publisher publisher_;
};

class Pair
{
public:
  Pair() : rear_("rear", "state")
  {
    front_.reset(new Wheel("front", "status"));
  }

private:
  std::unique_ptr<Wheel> front_;
  Wheel rear_;
};

template <typename M>
ros::Subscriber listen(ros::NodeHandle& nh, const std::string& topic)
{
  return nh.subscribe<M>(topic, 1, [](const boost::shared_ptr<M const>&) {});
}

struct Namespaced
{
  explicit Namespaced(const ros::NodeHandle& handle, std::string topic) : nh(handle)
  {
    publisher = nh.advertise<std_msgs::Int32>(topic, 1);
  }
  ros::NodeHandle nh;
  ros::Publisher publisher;
};

ros::Publisher inner(ros::NodeHandle& nh, const std::string& name, const std::string& more)
{
  return nh.advertise<std_msgs::Int64>(name + "/" + more, 1);
}

ros::Publisher outer(ros::NodeHandle& nh, const std::string& more)
{
  return inner(nh, "deep/inner", more);
}

int main(int argc, char** argv)
{
  ros::init(argc, argv, "choices_stay_together");
  ros::NodeHandle nh;
  ros::Publisher left = image(nh, "left", "image");
  ros::Publisher right = image(nh, "right", "depth");
  Pair pair;
  ros::Subscriber north = listen<geometry_msgs::Pose>(nh, "north");
  ros::Subscriber south = listen<geometry_msgs::Twist>(nh, "south");
  Namespaced one(ros::NodeHandle("a"), "one"), two(ros::NodeHandle("b"), "two");
  ros::Publisher x = outer(nh, "x"), y = outer(nh, "y");
  ros::spin();
}
