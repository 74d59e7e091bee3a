// Moves the arm along trajectories and works the gripper.

#include <cstdlib>
#include <string>
#include <vector>

#include <actionlib/server/simple_action_server.h>
#include <geometry_msgs/WrenchStamped.h>
#include <ros/ros.h>
#include <sensor_msgs/JointState.h>
#include <std_msgs/Float64.h>
#include <std_msgs/String.h>

#include <rover_core/MoveArmAction.h>
#include <rover_core/SetGripper.h>

namespace
{
double grip_force = 0.0;
double joint_error = 0.0;

// A plain function takes the message.
void onJointStates(const sensor_msgs::JointState& msg)
{
  joint_error = msg.effort.empty() ? 0.0 : msg.effort.front();
}
}  // namespace

class ArmServer
{
public:
  ArmServer() : private_nh_("~"), server_(nh_, "move_arm", boost::bind(&ArmServer::execute, this, _1), false)
  {
    // One publisher for each joint of the list.
    const std::vector<std::string> joints = {"shoulder", "elbow", "wrist"};
    for (const std::string& joint : joints)
      joint_pubs_.push_back(nh_.advertise<std_msgs::Float64>(joint + "_position/command", 1));

    gripper_pub_ = nh_.advertise<std_msgs::Float64>("gripper/command", 1);
    joint_states_sub_ = nh_.subscribe("joint_states", 10, onJointStates);
    watchFinger("left_finger");
    watchFinger("right_finger");

    set_gripper_srv_ = private_nh_.advertiseService("set_gripper", &ArmServer::setGripper, this);

    // The name is known only on the operator's machine.
    if (const char* topic = std::getenv("ROVER_ARM_TRACE"))
      trace_pub_ = nh_.advertise<std_msgs::String>(topic, 100);

    server_.start();
  }

private:
  /// The name of the topic arrives as an argument.
  void watchFinger(const std::string& finger)
  {
    finger_subs_.push_back(nh_.subscribe(finger + "/force", 1, &ArmServer::onForce, this));
  }

  void onForce(const geometry_msgs::WrenchStampedConstPtr& msg)
  {
    grip_force = msg->wrench.force.z;
  }

  bool setGripper(rover_core::SetGripper::Request& req, rover_core::SetGripper::Response& res)
  {
    std_msgs::Float64 command;
    command.data = req.width;
    gripper_pub_.publish(command);
    res.reached = grip_force < req.max_effort;
    trace_pub_.publish(std_msgs::String());
    return true;
  }
  void execute(const rover_core::MoveArmGoalConstPtr& goal)
  {
    for (const auto& point : goal->trajectory.points)
    {
      std_msgs::Float64 command;
      for (size_t i = 0; i < joint_pubs_.size(); ++i)
      {
        command.data = point.positions[i];
        joint_pubs_[i].publish(command);
      }
    }
    server_.setSucceeded();
  }

  ros::NodeHandle nh_, private_nh_;
  actionlib::SimpleActionServer<rover_core::MoveArmAction> server_;
  std::vector<ros::Publisher> joint_pubs_;
  std::vector<ros::Subscriber> finger_subs_;
  ros::Publisher gripper_pub_, trace_pub_;
  ros::Subscriber joint_states_sub_;
  ros::ServiceServer set_gripper_srv_;
};

int main(int argc, char** argv)
{
  ros::init(argc, argv, "arm_server");
  ArmServer server;
  ros::spin();
  return 0;
}
