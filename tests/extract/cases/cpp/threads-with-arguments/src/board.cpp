#include <pthread.h>

#include <thread>

#include <rclcpp/rclcpp.hpp>
#include <std_msgs/msg/bool.hpp>

struct Board {
  rclcpp::Node::SharedPtr node;
};

void* publish(void* given) {
  Board* board = static_cast<Board*>(given);
  int rate = board->node->declare_parameter("rate", 100);
  board->node->create_publisher<std_msgs::msg::Bool>("state", rate);
  return nullptr;
}

void listen(rclcpp::Node::SharedPtr node, const std::string& topic) {
  node->create_subscription<std_msgs::msg::Bool>(topic, 1, [](std_msgs::msg::Bool::SharedPtr) {});
}

int main(int argc, char** argv) {
  rclcpp::init(argc, argv);
  Board board{std::make_shared<rclcpp::Node>("board")};
  pthread_t thread;
  pthread_create(&thread, NULL, publish, (void*)&board);
  std::thread listener(listen, board.node, "stop");
  pthread_join(thread, NULL);
  listener.join();
}
