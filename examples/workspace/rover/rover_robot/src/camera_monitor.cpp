// Draws what the laser sees into the picture of the camera.

#include <boost/bind.hpp>
#include <image_transport/image_transport.h>
#include <message_filters/subscriber.h>
#include <message_filters/sync_policies/approximate_time.h>
#include <message_filters/synchronizer.h>
#include <ros/ros.h>
#include <sensor_msgs/CameraInfo.h>
#include <sensor_msgs/Image.h>
#include <sensor_msgs/LaserScan.h>
#include <sensor_msgs/image_encodings.h>
#include <tf2_ros/buffer.h>
#include <tf2_ros/transform_listener.h>

class CameraMonitor
{
public:
  explicit CameraMonitor(ros::NodeHandle nh) : listener_(buffer_), transport_(nh), sync_(Policy(10), depth_sub_, scan_sub_)
  {
    // A camera is a pair: the picture, and `camera_info` beside it.
    camera_sub_ = transport_.subscribeCamera("camera/image_raw", 1, &CameraMonitor::onCamera, this);
    annotated_pub_ = transport_.advertise("camera/annotated", 1);

    depth_sub_.subscribe(nh, "camera/depth", 5);
    scan_sub_.subscribe(nh, "scan_filtered", 5);
    sync_.registerCallback(boost::bind(&CameraMonitor::onBoth, this, _1, _2));
  }

private:
  using Policy = message_filters::sync_policies::ApproximateTime<sensor_msgs::Image, sensor_msgs::LaserScan>;

  void onCamera(const sensor_msgs::ImageConstPtr& image, const sensor_msgs::CameraInfoConstPtr& info)
  {
    if (buffer_.canTransform("laser", info->header.frame_id, image->header.stamp))
      annotated_pub_.publish(image);
  }

  void onBoth(const sensor_msgs::ImageConstPtr& depth, const sensor_msgs::LaserScanConstPtr& scan)
  {
    ROS_DEBUG_STREAM("picture and scan are " << (depth->header.stamp - scan->header.stamp) << " apart");
  }

  tf2_ros::Buffer buffer_;
  tf2_ros::TransformListener listener_;
  image_transport::ImageTransport transport_;
  image_transport::CameraSubscriber camera_sub_;
  image_transport::Publisher annotated_pub_;
  message_filters::Subscriber<sensor_msgs::Image> depth_sub_;
  message_filters::Subscriber<sensor_msgs::LaserScan> scan_sub_;
  message_filters::Synchronizer<Policy> sync_;
};

int main(int argc, char** argv)
{
  ros::init(argc, argv, "camera_monitor");
  ros::NodeHandle nh;
  CameraMonitor monitor(nh);
  ros::spin();
  return 0;
}
