#include "input.h"
#include "mixer.h"

Mixer::Mixer()
{
  inputs_ = boost::make_shared<inputs_type>();
  add("first", *inputs_);
  add("second", *inputs_);
}

template <typename T>
void Mixer::add(const std::string& topic, std::list<T>& inputs)
{
  inputs.emplace_back(nh_, topic);
}

int main(int argc, char** argv)
{
  ros::init(argc, argv, "lists_of_declared_classes");
  Mixer mixer;
  ros::spin();
}
