// nh.advertise<std_msgs::String>("comment", 1);
#define MAKE(nh) nh.advertise<std_msgs::String>("macro", 1)
/* create_publisher<A>("comment") */
const char* text = "nh.subscribe(\"string\", 1)";
auto raw = R"x(nh.param("raw", 1))x";
ros::Publisher NodeHandle::advertise(const std::string& name);
void f() {
  pub_ = nh.advertise<std_msgs::String>("a", 1);  // publishes
  sub_ =
    node->template create_subscription<
      A>("b", 1, [](A::SharedPtr) { done(); });
  create_publisher<A>("c", 1);
  client = rclcpp_action::create_client<Spin>(this, "spin");
  server = rclcpp::create_service<A>(base, "d");
  as_ = std::make_unique<actionlib::SimpleActionServer<B>>(nh, "e", false);
  if (ros::param::get("/f", f)) return;
  int rate = nh.param("rate", 10);
}
