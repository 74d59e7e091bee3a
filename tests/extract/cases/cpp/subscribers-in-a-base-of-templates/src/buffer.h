#pragma once
#include <functional>
#include <ros/ros.h>

template <typename M>
class Buffered {
  using Callback = std::function<void(const typename M::ConstPtr &)>;

public:
  Buffered(const ros::NodeHandle &nh) : nh_{nh} {}

  template <typename C, typename T>
  void subscribe(const std::string &topic, uint32_t queue, C &&callback, T *object) {
    subscribe(topic, queue, std::bind(callback, object, std::placeholders::_1));
  }

  void subscribe(const std::string &topic, uint32_t queue, Callback &&callback) {
    callback_ = callback;
    subscriber_ = nh_.subscribe(topic, queue, &Buffered<M>::receive, this);
  }

  void subscribe(const std::string &topic, uint32_t queue) { subscribe(topic, queue, nullptr); }

protected:
  void receive(const typename M::ConstPtr &message) { callback_(message); }

  ros::NodeHandle nh_;
  ros::Subscriber subscriber_;
  Callback callback_;
};
