#include <ros/ros.h>
#include <std_srvs/Empty.h>
template <class T, class Q, class A>
ros::ServiceServer offer(ros::NodeHandle& nh, const std::string& name, bool (T::*handler)(Q&, A&), T* of)
{
  return nh.advertiseService(name, handler, of);
}
template <class M, class T>
ros::Subscriber listen(ros::NodeHandle& nh, const std::string& name, void (T::*handler)(M), T* of)
{
  return nh.subscribe(name, 1, handler, of);
}
class N
{
public:
  N()
  {
    a_ = nh_.advertiseService("direct", &N::forget, this);
    b_ = offer(nh_, "wrapped", &N::forget, this);
    c_ = listen(nh_, "heard", &N::hear, this);
  }
  bool forget(std_srvs::EmptyRequest& req, std_srvs::EmptyResponse& res) { return true; }
  void hear(const std_msgs::String::ConstPtr& m) { }
  ros::NodeHandle nh_;
  ros::ServiceServer a_, b_;
  ros::Subscriber c_;
};
int main(int argc, char** argv)
{
  ros::init(argc, argv, "n");
  N n;
  ros::spin();
}
