#include <ros/ros.h>

struct Header
{
  std::string name;
  std::string type;
  bool packed;
};

class Relay
{
public:
  Relay() : handle_("~")
  {
    handle_.param("prefix", prefix_, std::string());
  }

  void receive(Header* header)
  {
    if (header->packed)
    {
      publisher_ = handle_.advertise<std_msgs::String>(prefix_ + header->name, 1);
    }
    else
    {
      ros::AdvertiseOptions options(prefix_ + header->name, 1, sum_, header->type, text_);
      publisher_ = handle_.advertise(options);
    }
  }

  void run()
  {
    char buffer[64];
    while (ros::ok() && read(0, buffer, 64) == 64)
      receive(reinterpret_cast<Header*>(buffer));
  }

private:
  ros::NodeHandle handle_;
  ros::Publisher publisher_;
  std::string prefix_, sum_, text_;
};

int main(int argc, char** argv)
{
  ros::init(argc, argv, "relay");
  Relay relay;
  relay.run();
}
