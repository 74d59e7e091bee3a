#include <example_interfaces/action/fibonacci.h>
#include <example_interfaces/srv/add_two_ints.h>
#include <rclc/executor.h>
#include <rclc/rclc.h>
#include <rclc_parameter/rclc_parameter.h>
#include <std_msgs/msg/int32.h>

#define CHECK(call) { rcl_ret_t code = call; if (code != RCL_RET_OK) { return 1; } }

rcl_publisher_t count;
std_msgs__msg__Int32 message;

void on_timer(rcl_timer_t * timer, int64_t last)
{
  (void) last;
  if (timer != NULL) {
    rcl_publish(&count, &message, NULL);
  }
}

int main(int argc, const char * const * argv)
{
  rcl_allocator_t allocator = rcl_get_default_allocator();
  rclc_support_t support;
  CHECK(rclc_support_init(&support, argc, argv, &allocator));

  const char * name = "counter";
  rcl_node_t node;
  CHECK(rclc_node_init_default(&node, name, "", &support));
  CHECK(rclc_publisher_init_default(&count, &node, ROSIDL_GET_MSG_TYPE_SUPPORT(std_msgs, msg, Int32), "count"));

  rcl_subscription_t reset;
  CHECK(rclc_subscription_init_best_effort(
    &reset, &node, ROSIDL_GET_MSG_TYPE_SUPPORT(std_msgs, msg, Bool), "reset"));

  rcl_service_t add;
  CHECK(rclc_service_init_default(
    &add, &node, ROSIDL_GET_SRV_TYPE_SUPPORT(example_interfaces, srv, AddTwoInts), "/add"));

  rcl_client_t sum;
  CHECK(rclc_client_init_default(
    &sum, &node, ROSIDL_GET_SRV_TYPE_SUPPORT(example_interfaces, srv, AddTwoInts), "/sum"));

  rclc_action_server_t series;
  CHECK(rclc_action_server_init_default(
    &series, &node, &support, ROSIDL_GET_ACTION_TYPE_SUPPORT(example_interfaces, Fibonacci), "series"));

  rclc_action_client_t other;
  CHECK(rclc_action_client_init_default(
    &other, &node, ROSIDL_GET_ACTION_TYPE_SUPPORT(example_interfaces, Fibonacci), "other"));

  rclc_parameter_server_t parameters;
  rclc_parameter_server_init_default(&parameters, &node);
  rclc_add_parameter(&parameters, "rate", RCLC_PARAMETER_INT);

  rclc_executor_t executor;
  CHECK(rclc_executor_init(&executor, &support.context, 1, &allocator));
  rclc_executor_spin(&executor);
  return 0;
}
