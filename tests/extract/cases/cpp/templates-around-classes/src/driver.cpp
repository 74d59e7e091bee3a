#include <boost/msm/back/state_machine.hpp>
#include <boost/msm/front/state_machine_def.hpp>
#include <ros/ros.h>
#include <std_msgs/String.h>

class States : public boost::msm::front::state_machine_def<States> {
public:
  States(const ros::NodeHandle& nh, const ros::NodeHandle& pnh) : nh_(nh), pnh_(pnh) {
    state_ = nh_.advertise<std_msgs::String>("state", 1);
    pnh_.param<double>("timeout", timeout_, 2.0);
  }

private:
  ros::NodeHandle nh_, pnh_;
  ros::Publisher state_;
  double timeout_;
};
typedef boost::msm::back::state_machine<States, boost::msm::back::mpl_graph_fsm_check> Machine;

// An object of it has a node, which the registry below does not get.
class Other {
public:
  explicit Other(const ros::NodeHandle& nh) { nh.advertise<std_msgs::String>("other", 1); }
};

int main(int argc, char** argv) {
  ros::init(argc, argv, "driver");
  ros::NodeHandle nh, pnh("~");
  std::unique_ptr<Machine> machine;
  machine.reset(new Machine(nh, pnh));
  vendor::Registry<Other> registry("others");
  machine->start();
  ros::spin();
}
