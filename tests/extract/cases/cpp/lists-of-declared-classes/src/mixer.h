#ifndef MIXER_H
#define MIXER_H

#include <ros/ros.h>
#include <list>
#include <string>

class Input;

class Mixer
{
public:
  typedef std::list<Input> inputs_type;

  Mixer();

private:
  template <typename T>
  void add(const std::string& topic, std::list<T>& inputs);

  ros::NodeHandle nh_;
  boost::shared_ptr<inputs_type> inputs_;
};

#endif
