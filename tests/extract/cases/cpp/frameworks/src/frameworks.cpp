#include <actionlib/client/simple_action_client.h>
#include <actionlib/server/simple_action_server.h>
#include <camera_info_manager/camera_info_manager.h>
#include <control_msgs/FollowJointTrajectoryAction.h>
#include <control_msgs/GripperCommandAction.h>
#include <diagnostic_updater/diagnostic_updater.h>
#include <dynamic_reconfigure/server.h>
#include <frameworks/TuneConfig.h>
#include <geometry_msgs/Twist.h>
#include <image_transport/image_transport.h>
#include <image_transport/subscriber_filter.h>
#include <message_filters/subscriber.h>
#include <message_filters/synchronizer.h>
#include <move_base_msgs/MoveBaseAction.h>
#include <nav_msgs/Odometry.h>
#include <pcl_ros/point_cloud.h>
#include <pcl_ros/publisher.h>
#include <polled_camera/publication_server.h>
#include <realtime_tools/realtime_publisher.h>
#include <ros/ros.h>
#include <sensor_msgs/CameraInfo.h>
#include <sensor_msgs/PointCloud2.h>
#include <std_msgs/Empty.h>
#include <std_srvs/Empty.h>
#include <rosparam_shortcuts/rosparam_shortcuts.h>
#include <swri_roscpp/swri_roscpp.h>
#include <vikit/params_helper.h>
#include <tf/transform_listener.h>
#include <tf2_ros/static_transform_broadcaster.h>

typedef pcl::PointCloud<pcl::PointXYZ> Cloud;
typedef actionlib::SimpleActionClient<move_base_msgs::MoveBaseAction> DockClient;

class Arm
{
  typedef actionlib::SimpleActionClient<control_msgs::FollowJointTrajectoryAction> Client;

public:
  explicit Arm(const std::string& name)
  {
    client_ = boost::make_shared<Client>(name, true);
  }

private:
  boost::shared_ptr<Client> client_;
};

class Frameworks
{
public:
  Frameworks()
    : own_("~")
    , transport_(own_)
    , left_(nh_, "left", 1)
    , info_(nh_, "info", 1)
    , server_(nh_, "move", boost::bind(&Frameworks::move, this, _1), false)
    , camera_info_(own_, "camera")
    , tuner_(own_)
  {
    image_ = transport_.advertise("image", 1);
    poll_ = polled_camera::advertise(nh_, "request_image", &Frameworks::poll, this);
    camera_ = transport_.advertiseCamera("stereo/image_raw", 1);
    image_transport::ImageTransport shared(nh_);
    subscriber_ = shared.subscribe("camera/image", 1, &Frameworks::image, this);
    pair_ = shared.subscribeCamera("rgb/image", 1, &Frameworks::camera, this);
    right_.reset(new message_filters::Subscriber<sensor_msgs::Image>(nh_, "right", 1));
    later_.subscribe(nh_, "later", 5);
    filter_.subscribe(shared, "filter", 1);
    gripper_.reset(new actionlib::SimpleActionServer<control_msgs::GripperCommandAction>(own_, "grip", false));
    realtime_.reset(new realtime_tools::RealtimePublisher<geometry_msgs::Twist>(nh_, "velocity", 4));
    points_ = nh_.advertise<Cloud>("points", 1);
    filtered_.advertise(nh_, "filtered", 1);
    cloud_ = nh_.subscribe<Cloud>("pcl", 1, &Frameworks::cloud, this);
    ros::topic::waitForMessage<std_msgs::Empty>("once");
    tuner_.setCallback(boost::bind(&Frameworks::tune, this, _1, _2));
  }

private:
  void move(const move_base_msgs::MoveBaseGoalConstPtr& goal) {}
  void image(const sensor_msgs::ImageConstPtr& image) {}
  void camera(const sensor_msgs::ImageConstPtr& image, const sensor_msgs::CameraInfoConstPtr& info) {}
  void cloud(const Cloud::ConstPtr& cloud) {}
  void tune(frameworks::TuneConfig& config, uint32_t level) {}

  ros::NodeHandle nh_, own_;
  image_transport::ImageTransport transport_;
  image_transport::Publisher image_;
  image_transport::CameraPublisher camera_;
  image_transport::Subscriber subscriber_;
  image_transport::CameraSubscriber pair_;
  message_filters::Subscriber<sensor_msgs::Image> left_;
  std::unique_ptr<message_filters::Subscriber<sensor_msgs::Image>> right_;
  message_filters::Subscriber<sensor_msgs::CameraInfo> info_;
  message_filters::Subscriber<nav_msgs::Odometry> later_;
  image_transport::SubscriberFilter filter_;
  actionlib::SimpleActionServer<move_base_msgs::MoveBaseAction> server_;
  std::unique_ptr<actionlib::SimpleActionServer<control_msgs::GripperCommandAction>> gripper_;
  std::unique_ptr<realtime_tools::RealtimePublisher<geometry_msgs::Twist>> realtime_;
  camera_info_manager::CameraInfoManager camera_info_;
  dynamic_reconfigure::Server<frameworks::TuneConfig> tuner_;
  diagnostic_updater::Updater updater_;
  tf::TransformListener listener_;
  tf2_ros::StaticTransformBroadcaster broadcaster_;
  ros::Publisher points_;
  pcl_ros::Publisher<pcl::PointXYZ> filtered_;
  ros::Subscriber cloud_;
  polled_camera::PublicationServer poll_;
};

void onSync(const std_msgs::EmptyConstPtr& message) {}
bool onReset(std_srvs::Empty::Request& request, std_srvs::Empty::Response& response) { return true; }

int main(int argc, char** argv)
{
  ros::init(argc, argv, "frameworks");
  Frameworks frameworks;
  ros::NodeHandle node;
  ros::Publisher fix = swri::advertise<sensor_msgs::PointCloud2>(node, "fix", 1);
  swri::Subscriber sync(node, "sync", 10, onSync);
  swri::ServiceServer reset(node, "reset", onReset);
  double gain = vk::getParam<double>("estimator/gain", 0.5);
  std::vector<std::string> joints;
  rosparam_shortcuts::get("driver", node, "joints", joints);
  DockClient dock("dock", true);
  Arm arm("/arm/follow");
  ros::spin();
}
