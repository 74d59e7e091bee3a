#include <functional>
#include <rclcpp/rclcpp.hpp>
#include <std_msgs/msg/string.hpp>

using Work = std::function<void(int)>;

/// Its first constructor is in a library outside of the sources.
class Worker
{
public:
  Worker(Work work, const std::string & topic = "work");

  template <class T>
  Worker(void (T::*method)(int), T * object, const std::string & topic = "work");

  template <class T>
  Worker(void (T::*method)(int) const, T * object, const std::string & topic = "work");
};

template <class T>
Worker::Worker(void (T::*method)(int), T * object, const std::string & topic)
: Worker(std::bind(method, object, std::placeholders::_1), topic)
{
}

template <class T>
Worker::Worker(void (T::*method)(int) const, T * object, const std::string & topic)
: Worker(std::bind(method, object, std::placeholders::_1), topic)
{
}

class Sender : public rclcpp::Node
{
public:
  Sender() : Node("sender"), worker_(&Sender::work, this, "done")
  {
    publisher_ = create_publisher<std_msgs::msg::String>("done", 1);
  }

private:
  void work(int) {}
  Worker worker_;
  rclcpp::Publisher<std_msgs::msg::String>::SharedPtr publisher_;
};

int main(int argc, char ** argv)
{
  rclcpp::init(argc, argv);
  rclcpp::spin(std::make_shared<Sender>());
}
