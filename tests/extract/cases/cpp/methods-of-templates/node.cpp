#include <ros/ros.h>
#include <std_srvs/Empty.h>
#include <std_srvs/SetBool.h>

// A method of a class template, named with or without its arguments, has the types that the object has.
template <typename V, typename SB>
class Tracker {
public:
  bool init(const ros::NodeHandle& n);
  bool bound(typename SB::Request& req, typename SB::Response& res) { return true; }
  void watch(ros::NodeHandle& n);
  ros::ServiceServer srv_, other_;
  ros::ServiceClient client_;
};
template <typename V, typename SB>
bool Tracker<V, SB>::init(const ros::NodeHandle& n) {
  ros::NodeHandle nl(n);
  srv_ = nl.advertiseService("b", &Tracker<V, SB>::bound, this);
  other_ = nl.advertiseService("c", &Tracker::bound, this);
  return true;
}
// Its definition can have other names for the parameters of the class.
template <typename A, typename B>
void Tracker<A, B>::watch(ros::NodeHandle& n) {
  client_ = n.serviceClient<B>("d");
}
typedef Tracker<int, std_srvs::SetBool> T;
int main(int argc, char** argv)
{
  ros::init(argc, argv, "server");
  ros::NodeHandle n("~");
  T t;
  t.init(n);
  t.watch(n);
}
