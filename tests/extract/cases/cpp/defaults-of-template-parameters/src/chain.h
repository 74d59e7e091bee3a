#include <ros/ros.h>

template <typename T>
class Base
{
public:
  virtual ~Base() = default;

protected:
  virtual void init(ros::NodeHandle handle) {out_ = handle.template advertise<T>("out", 1);}
  ros::Publisher out_;
};

template <typename T, typename B = Base<T>>
class Chain : public B
{
public:
  explicit Chain(ros::NodeHandle handle) : B() {this->init(handle);}
};

template <typename T, typename B = Base<T>>
void spin(const std::string & name, int argc, char ** argv)
{
  ros::init(argc, argv, name);
  ros::NodeHandle handle("~");
  const Chain<T, B> chain(handle);
  ros::spin();
}
