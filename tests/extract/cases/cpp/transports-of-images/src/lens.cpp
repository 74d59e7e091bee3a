// Subscribers of images that ask for a transport get another topic.
#include <image_transport/image_transport.h>
#include <image_transport/subscriber_filter.h>
#include <ros/ros.h>

void onImage(const sensor_msgs::ImageConstPtr & image) {}

class Lens
{
public:
  explicit Lens(ros::NodeHandle & handle) : transport_(handle), near_(transport_, "near", 1, hints_)
  {
    far_ = transport_.subscribe("far", 1, &Lens::onFar, this, image_transport::TransportHints("theora"));
    plain_ = transport_.subscribe("plain", 1, &Lens::onFar, this, image_transport::TransportHints("raw"));
    usual_ = transport_.subscribe("usual", 1, &Lens::onFar, this);
  }

private:
  void onFar(const sensor_msgs::ImageConstPtr & image) {}

  image_transport::TransportHints hints_{"compressedDepth"};
  image_transport::ImageTransport transport_;
  image_transport::SubscriberFilter near_;
  image_transport::Subscriber far_, plain_, usual_;
};

int main(int argc, char ** argv)
{
  ros::init(argc, argv, "lens");
  ros::NodeHandle handle, own("~");
  image_transport::ImageTransport transport(handle);
  image_transport::TransportHints hints("compressed", ros::TransportHints(), own);
  image_transport::Subscriber wide = transport.subscribe("wide", 1, onImage, ros::VoidPtr(), hints);
  image_transport::CameraSubscriber camera = transport.subscribeCamera("lens/image", 1, onCamera, hints);
  std::string wanted;
  own.getParam("wanted", wanted);
  image_transport::Subscriber open =
    transport.subscribe("open", 1, onImage, ros::VoidPtr(), image_transport::TransportHints(wanted));
  Lens lens(handle);
  ros::spin();
}
