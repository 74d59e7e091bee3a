#pragma once

#include <memory>

#include <rclcpp/rclcpp.hpp>

// Data of one frame, which is there or not.
template <class Data>
class Cache {
 public:
  Cache& operator=(std::shared_ptr<Data> data) {
    data_ = data;
    return *this;
  }
  const Data* operator->() const { return data_.get(); }
  Data* operator->() { return data_.get(); }

 private:
  std::shared_ptr<Data> data_;
};

struct Frame {
  virtual ~Frame() = default;
  Cache<rclcpp::Node> node;
};
