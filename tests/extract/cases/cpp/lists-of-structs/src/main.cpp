#include <geometry_msgs/Twist.h>
#include <ros/ros.h>
#include <std_msgs/Bool.h>
#include <std_msgs/String.h>
#include <list>
#include <string>

template <typename T>
void fetch(XmlRpc::XmlRpcValue& whole, const std::string& member, T& output)
{
  output = static_cast<T>(whole[member]);
}

template <typename T>
class Input
{
public:
  Input(ros::NodeHandle& nh, const std::string& name, const std::string& topic) : nh_(nh), name_(name), topic_(topic) {}

protected:
  ros::NodeHandle nh_;
  std::string name_;
  std::string topic_;
  ros::Subscriber subscriber_;
};

class Velocity : public Input<geometry_msgs::Twist>
{
  typedef Input<geometry_msgs::Twist> base_type;

public:
  Velocity(ros::NodeHandle& nh, const std::string& name, const std::string& topic) : base_type(nh, name, topic)
  {
    subscriber_ = nh_.subscribe(topic_, 1, &Velocity::received, this);
  }

  void received(const geometry_msgs::TwistConstPtr&) {}
};

class Lock : public Input<std_msgs::Bool>
{
  typedef Input<std_msgs::Bool> base_type;

public:
  Lock(ros::NodeHandle& nh, const std::string& name, const std::string& topic) : base_type(nh, name, topic)
  {
    subscriber_ = nh_.subscribe(topic_, 1, &Lock::received, this);
  }

  void received(const std_msgs::BoolConstPtr&) {}
};

class Multiplexer
{
public:
  Multiplexer()
  {
    ros::NodeHandle own("~");
    read(own, "topics", velocities_);
    read(own, "locks", locks_);
    XmlRpc::XmlRpcValue echoes;
    own.getParam("echoes", echoes);
    for (int i = 0; i < echoes.size(); ++i)
    {
      std::string name = static_cast<std::string>(echoes[i]);
      echo_ = nh_.advertise<std_msgs::String>(name, 1);
    }
  }

private:
  template <typename T>
  void read(ros::NodeHandle& own, const std::string& parameter, std::list<T>& inputs)
  {
    XmlRpc::XmlRpcValue listed;
    own.getParam(parameter, listed);
    std::string name, topic;
    for (int i = 0; i < listed.size(); ++i)
    {
      XmlRpc::XmlRpcValue element = listed[i];
      fetch(element, "name", name);
      fetch(element, "topic", topic);
      inputs.emplace_back(nh_, name, topic);
    }
  }

  ros::NodeHandle nh_;
  ros::Publisher echo_;
  std::list<Velocity> velocities_;
  std::list<Lock> locks_;
};

int main(int argc, char** argv)
{
  ros::init(argc, argv, "mux");
  Multiplexer multiplexer;
  ros::spin();
  return 0;
}
