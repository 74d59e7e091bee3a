#include <rclc/executor.h>
#include <rclc/rclc.h>
#include <std_msgs/msg/int32.h>
int main(int argc, const char * const * argv)
{
  rcl_allocator_t allocator = rcl_get_default_allocator();
  rclc_support_t support;
  rclc_support_init(&support, argc, argv, &allocator);
  rcl_node_t first;
  rclc_node_init_default(&first, "first", "", &support);
  rcl_node_t second = rcl_get_zero_initialized_node();
  rclc_node_init_default(&second, "second", "", &support);
  rcl_publisher_t a, b, c;
  rclc_publisher_init_default(&a, &first, ROSIDL_GET_MSG_TYPE_SUPPORT(std_msgs, msg, Int32), "count");
  rclc_publisher_init_default(&b, &second, ROSIDL_GET_MSG_TYPE_SUPPORT(std_msgs, msg, Int32), "count");
  rclc_publisher_init_default(&c, &second, ROSIDL_GET_MSG_TYPE_SUPPORT(std_msgs, msg, Int32), "only_second");
  rclc_executor_t executor;
  rclc_executor_spin(&executor);
  return 0;
}
