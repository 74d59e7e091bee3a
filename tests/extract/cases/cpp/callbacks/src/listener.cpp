#include "listener.hpp"

Listener::Listener(ros::NodeHandle& nh)
{
  subscribers_.push_back(nh.subscribe("member", 1, &Listener::member, this));
  subscribers_.push_back(nh.subscribe("elsewhere", 1, &Listener::elsewhere, this));
  subscribers_.push_back(nh.subscribe("inherited", 1, &Base::inherited, static_cast<Base*>(this)));
  subscribers_.push_back(nh.subscribe<sensor_msgs::Imu>("bound", 1, boost::bind(&Listener::bound, this, _1, 3)));
  boost::function<void(const sensor_msgs::Joy::ConstPtr&)> handler = boost::bind(&Listener::second, this, "left", _1);
  subscribers_.push_back(nh.subscribe("bound_second", 1, handler));
  subscribers_.push_back(nh.subscribe<sensor_msgs::Range>("lambda", 1, [](const sensor_msgs::Range::ConstPtr& r) {}));
  subscribers_.push_back(nh.subscribe("stored", 1, stored_));
  subscribers_.push_back(nh.subscribe<nav_msgs::Odometry>("explicit", 1, [this](auto& m) { (void)m; }));
  subscribers_.push_back(nh.subscribe("templated", 1, &Listener::any<nav_msgs::Path>, this));
}

void Listener::elsewhere(const geometry_msgs::Pose::ConstPtr& pose)
{
}

void Base::inherited(const geometry_msgs::PointConstPtr& point)
{
}
