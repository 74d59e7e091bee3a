#include <ros/ros.h>
#include <std_msgs/Bool.h>
#include <std_msgs/String.h>

// A driver keeps functions for each kind of packet and calls them from the thread of its port: what they advertise
// has the type that they were instantiated with.
boost::shared_ptr<ros::NodeHandle> nh;

template <typename Message>
void publish(const Message& message, const std::string& topic)
{
  static ros::Publisher publisher = nh->advertise<Message>(topic, 5);
  publisher.publish(message);
}

class Handler
{
public:
  virtual void handle(Packet& packet) = 0;
};

template <typename T>
class HandlerOf : public Handler
{
public:
  typedef boost::function<void(const T&)> Callback;
  HandlerOf(const Callback& callback = Callback()) : callback_(callback) {}

  void handle(Packet& packet)
  {
    try {
      if (!packet.read<T>(message_)) return;
    } catch (std::runtime_error& error) {
      return;
    }
    if (callback_) callback_(message_);
  }

private:
  Callback callback_;
  T message_;
};

class Handlers
{
public:
  template <typename T>
  void add(typename HandlerOf<T>::Callback callback)
  {
    HandlerOf<T>* handler = new HandlerOf<T>(callback);
    kept_.insert(std::make_pair(T::KIND, boost::shared_ptr<Handler>(handler)));
  }

  void read(Packet& packet)
  {
    for (Kept::iterator it = kept_.lower_bound(packet.kind()); it != kept_.upper_bound(packet.kind()); ++it)
      it->second->handle(packet);
  }

private:
  typedef std::multimap<int, boost::shared_ptr<Handler> > Kept;
  Kept kept_;
};

int main(int argc, char** argv)
{
  ros::init(argc, argv, "server");
  nh.reset(new ros::NodeHandle("~"));
  Handlers handlers;
  Port port;
  port.onPacket(boost::bind(&Handlers::read, &handlers, _1));
  if (nh->param("flags", false)) handlers.add<std_msgs::Bool>(boost::bind(publish<std_msgs::Bool>, _1, "flag"));
  handlers.add<std_msgs::String>(boost::bind(publish<std_msgs::String>, _1, "text"));
  ros::spin();
}
