#include <ros/ros.h>
#include <boost/format.hpp>
#include <sstream>
#include <std_msgs/String.h>
#include "texts/constants.hpp"

const std::string texts::Names::MEMBER = "member/constant";

using M = std_msgs::String;

std::string computed();

int main(int argc, char** argv)
{
  ros::init(argc, argv, "texts");
  ros::NodeHandle nh;
  std::vector<ros::Publisher> all;
  all.push_back(nh.advertise<M>("camera/" + std::string("left") + "/image", 1));
  all.push_back(nh.advertise<M>("adjacent"
                                "/name", 1));
  std::string first = "plus";
  const std::string whole = first + '/' + "name";
  all.push_back(nh.advertise<M>(whole, 1));
  std::string appended("appended");
  appended += "/name";
  appended.append("/more");
  all.push_back(nh.advertise<M>(appended.c_str(), 1));
  std::stringstream stream;
  stream << "stream/" << 3 << "/name";
  all.push_back(nh.advertise<M>(stream.str(), 1));
  int number = 7;
  all.push_back(nh.advertise<M>("number/" + std::to_string(number), 1));
  all.push_back(nh.advertise<M>((boost::format("printed/%d") % 2).str(), 1));
  all.push_back(nh.advertise<M>(DEFINED, 1));
  all.push_back(nh.advertise<M>(DEFINED "/below", 1));
  all.push_back(nh.advertise<M>(texts::kConstant, 1));
  all.push_back(nh.advertise<M>(texts::Names::MEMBER, 1));
  all.push_back(nh.advertise<M>(texts::Names::kEnumerated, 1));
  all.push_back(nh.advertise<M>(R"(raw)", 1));
  all.push_back(nh.advertise<M>(argc > 1 ? "yes" : "no", 1));
  all.push_back(nh.advertise<M>(ros::names::append("joined", "up"), 1));
  all.push_back(nh.advertise<M>(std::string("uncut").substr(2), 1));
  all.push_back(nh.advertise<M>(computed() + "/known", 1));
  all.push_back(nh.advertise<M>(computed(), 1));
  std::string branch;
  if (argc > 2)
  {
    branch = "branch/a";
  }
  else
  {
    branch = "branch/b";
  }
  all.push_back(nh.advertise<M>(branch, 1));
  ros::spin();
}
