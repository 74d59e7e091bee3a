#pragma once
#include "buffer.h"

template <typename M>
class Timed : private Buffered<M> {
  using Callback = std::function<void(const typename M::ConstPtr &)>;
  using Base = Buffered<M>;

public:
  Timed(const ros::NodeHandle &nh) : Base{nh} {}

  template <typename C, typename D, typename T, typename U>
  void subscribe(const std::string &topic, uint32_t queue, C &&callback, T *first, D &&late, U *second,
                 const ros::Duration timeout) {
    subscribe(topic, queue, std::bind(callback, first, std::placeholders::_1), std::bind(late, second), timeout);
  }

  void subscribe(const std::string &topic, uint32_t queue, Callback &&callback, std::function<void()> &&late,
                 const ros::Duration timeout) {
    callback_ = callback;
    late_ = late;
    Base::subscribe(topic, queue, &Timed<M>::receive, this);
    timer_ = this->nh_.createTimer(timeout, &Timed<M>::expire, this, true, false);
  }

  void subscribe(const std::string &topic, uint32_t queue, const ros::Duration timeout) {
    subscribe(topic, queue, nullptr, nullptr, timeout);
  }

private:
  void receive(const typename M::ConstPtr &message) { callback_(message); }
  void expire(const ros::TimerEvent &) { late_(); }

  ros::Timer timer_;
  Callback callback_;
  std::function<void()> late_;
};
