#include <cstdlib>
#include <vector>

#include <ros/ros.h>
#include <std_msgs/Bool.h>

class Task
{
public:
  virtual void run(ros::NodeHandle & handle) = 0;
};

class Knock : public Task
{
public:
  void run(ros::NodeHandle & handle) override
  {
    publisher_ = handle.advertise<std_msgs::Bool>("knock", 1);
  }

private:
  ros::Publisher publisher_;
};

class Listen : public Task
{
public:
  void run(ros::NodeHandle & handle) override
  {
    subscriber_ = handle.subscribe("voice", 1, &Listen::onVoice, this);
  }
  void onVoice(const std_msgs::Bool::ConstPtr &) {}

private:
  ros::Subscriber subscriber_;
};

struct Errand
{
  explicit Errand(Task * one)
  : task(one) {}
  Task * task;
  bool open = true;
  bool noisy = false;
};

Errand * next(std::vector<Errand> & errands)
{
  for (size_t i = 0; i < errands.size(); i++) {
    if (errands[i].open) {
      errands[i].open = false;
      return &errands[i];
    }
  }
  return nullptr;
}

int main(int argc, char ** argv)
{
  ros::init(argc, argv, "errands");
  ros::NodeHandle handle;
  ros::Publisher noise;
  std::vector<Errand> errands;
  for (int count = 0; count < 8; count++) {
    if (rand() % 2 == 0) {
      errands.push_back(Errand(new Knock()));
    } else {
      errands.push_back(Errand(new Listen()));
    }
  }
  while (ros::ok()) {
    Errand * errand = next(errands);
    if (errand != nullptr) {
      errand->task->run(handle);
      if (errand->noisy) {
        noise = handle.advertise<std_msgs::Bool>("noise", 1);
      }
    }
    ros::spinOnce();
  }
}
