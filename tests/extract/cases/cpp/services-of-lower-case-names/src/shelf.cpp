#include <ros/ros.h>
#include <toolbox/addTool.h>

namespace toolbox
{
class Shelf
{
public:
  Shelf() { server_ = handle_.advertiseService("add", &Shelf::addTool, this); }
  bool addTool(addTool::Request& request, addTool::Response& response);

private:
  ros::NodeHandle handle_;
  ros::ServiceServer server_;
};

bool Shelf::addTool(addTool::Request& request, addTool::Response& response)
{
  response.done = !request.name.empty();
  return true;
}
}  // namespace toolbox

int main(int argc, char ** argv)
{
  ros::init(argc, argv, "shelf");
  toolbox::Shelf shelf;
  ros::spin();
  return 0;
}
