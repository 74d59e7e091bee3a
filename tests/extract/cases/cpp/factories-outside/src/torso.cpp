#include <vendor/module.h>

#include <ros/ros.h>
#include <std_msgs/Bool.h>

class Balance : public vendor::Module
{
public:
  Balance(boost::shared_ptr<vendor::Broker> broker, const std::string & name)
  : vendor::Module(broker, name), name_(name)
  {
  }

  void setup(ros::NodeHandle * handle)
  {
    publisher_ = handle->advertise<std_msgs::Bool>(name_ + "/balanced", 1);
  }

private:
  std::string name_;
  ros::Publisher publisher_;
};

int main(int argc, char ** argv)
{
  ros::init(argc, argv, "torso");
  ros::NodeHandle handle;
  boost::shared_ptr<vendor::Broker> broker = vendor::Broker::open("localhost");
  boost::shared_ptr<Balance> balance = vendor::Module::createModule<Balance>(broker, "balance");
  balance->setup(&handle);
  ros::spin();
}
