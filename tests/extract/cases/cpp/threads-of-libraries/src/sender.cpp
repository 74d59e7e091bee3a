#include <OpenThreads/Thread>
#include <ros/ros.h>
#include <std_msgs/String.h>

class Worker : public OpenThreads::Thread
{
public:
  explicit Worker(const std::string & topic) : topic_(topic) { startThread(); }
  virtual void run() { create(node_); }
  virtual void create(ros::NodeHandle & node) = 0;

protected:
  std::string topic_;
  ros::NodeHandle node_;
};

class Sender : public Worker
{
public:
  explicit Sender(const std::string & topic) : Worker(topic) {}
  virtual void create(ros::NodeHandle & node) { sent_ = node.advertise<std_msgs::String>(topic_, 1); }

private:
  ros::Publisher sent_;
};

int main(int argc, char ** argv)
{
  ros::init(argc, argv, "sender");
  std::vector<boost::shared_ptr<Worker> > workers;
  workers.push_back(boost::shared_ptr<Sender>(new Sender("sent")));
  ros::spin();
}
