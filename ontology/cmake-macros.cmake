# Macros of well-known packages, described by what they declare, in CMake's own language.
#
# `kg` runs a macro from here when a package calls it and the build does not hold the package that defines it.
# Only what makes targets, links, plugins or programs matters. Known commands to describe others with:
# add_executable, add_library, target_sources, target_link_libraries, set_target_properties, install,
# rclcpp_components_register_node(s), pluginlib_export_plugin_description_file, and kg_add_test(name source...),
# which declares a test, and kg_plugin_executable(executable plugin), a program that runs one plugin. `kg_build_dependencies` holds what package.xml depends on to build.

# --- ament_cmake_auto

macro(ament_auto_find_build_dependencies)
  foreach(kg_dependency IN LISTS kg_build_dependencies)
    find_package(${kg_dependency})
  endforeach()
endmacro()

macro(ament_auto_find_test_dependencies)
endmacro()

macro(kg_auto_sources target)
  cmake_parse_arguments(kg "" "" "DIRECTORY" ${ARGN})
  foreach(kg_folder IN LISTS kg_DIRECTORY)
    file(GLOB_RECURSE kg_sources ${kg_folder}/*.c ${kg_folder}/*.cc ${kg_folder}/*.cpp ${kg_folder}/*.cxx)
    target_sources(${target} PRIVATE ${kg_sources})
  endforeach()
  target_link_libraries(${target} ${kg_build_dependencies})
endmacro()

macro(ament_auto_add_library target)
  add_library(${target} ${ARGN})
  kg_auto_sources(${target} ${ARGN})
  list(APPEND kg_auto_libraries ${target})
endmacro()

macro(ament_auto_add_executable target)
  add_executable(${target} ${ARGN})
  kg_auto_sources(${target} ${ARGN})
  target_link_libraries(${target} ${kg_auto_libraries})
endmacro()

macro(ament_auto_add_gtest target)
  kg_add_test(${target} ${ARGN})
  target_link_libraries(${target} ${kg_auto_libraries} ${kg_build_dependencies})
endmacro()

macro(ament_auto_package)
  cmake_parse_arguments(kg "" "INSTALL_TO_PATH" "INSTALL_TO_SHARE" ${ARGN})
  install(DIRECTORY ${kg_INSTALL_TO_SHARE} DESTINATION share/${PROJECT_NAME})
endmacro()

# --- tests of ament and catkin

macro(ament_add_gtest target)
  kg_add_test(${target} ${ARGN})
endmacro()

macro(ament_add_gmock target)
  kg_add_test(${target} ${ARGN})
endmacro()

macro(ament_add_gtest_executable target)
  kg_add_test(${target} ${ARGN})
endmacro()

macro(ament_add_google_benchmark target)
  kg_add_test(${target} ${ARGN})
endmacro()

macro(ament_add_ros_isolated_gtest target)
  kg_add_test(${target} ${ARGN})
endmacro()

macro(ament_add_ros_isolated_gmock target)
  kg_add_test(${target} ${ARGN})
endmacro()

macro(add_ros_isolated_gtest target)
  kg_add_test(${target} ${ARGN})
endmacro()

macro(catkin_add_gtest target)
  kg_add_test(${target} ${ARGN})
endmacro()

macro(catkin_add_gmock target)
  kg_add_test(${target} ${ARGN})
endmacro()

macro(catkin_add_executable_with_gtest target)
  kg_add_test(${target} ${ARGN})
endmacro()

macro(catkin_add_executable_with_gmock target)
  kg_add_test(${target} ${ARGN})
endmacro()

macro(add_rostest_gtest target test)
  kg_add_test(${target} ${ARGN})
endmacro()

macro(add_rostest_gmock target test)
  kg_add_test(${target} ${ARGN})
endmacro()

macro(add_rostest_with_parameters_gmock target)
  kg_add_test(${target} ${ARGN})
endmacro()

# --- catkin_simple

macro(cs_add_executable target)
  add_executable(${target} ${ARGN})
  target_link_libraries(${target} ${catkin_LIBRARIES} ${kg_build_dependencies} ${kg_simple_libraries})
endmacro()

macro(cs_add_library target)
  add_library(${target} ${ARGN})
  target_link_libraries(${target} ${catkin_LIBRARIES} ${kg_build_dependencies})
  list(APPEND kg_simple_libraries ${target})
endmacro()

# --- rosbuild

macro(rosbuild_add_executable target)
  get_filename_component(program ${target} NAME)
  add_executable(${program} ${ARGN})
  target_link_libraries(${program} ${kg_build_dependencies})
endmacro()

macro(rosbuild_add_library target)
  add_library(${target} ${ARGN})
  target_link_libraries(${target} ${kg_build_dependencies})
endmacro()

macro(rosbuild_add_gtest target)
  kg_add_test(${target} ${ARGN})
endmacro()

macro(rosbuild_link_boost)
endmacro()

# --- FindCUDA and others that wrap add_executable and add_library

macro(cuda_add_executable target)
  add_executable(${target} ${ARGN})
endmacro()

macro(cuda_add_library target)
  add_library(${target} ${ARGN})
endmacro()

macro(hip_add_executable target)
  add_executable(${target} ${ARGN})
endmacro()

macro(qt_add_executable target)
  add_executable(${target} ${ARGN})
endmacro()

macro(pcl_add_executable target)
  add_executable(${target} ${ARGN})
endmacro()

macro(pybind11_add_module target)
  add_library(${target} ${ARGN})
endmacro()

macro(ament_python_install_module)
endmacro()

macro(ament_export_plugin_description_file category path)
  pluginlib_export_plugin_description_file(${category} ${path})
endmacro()

# --- jsk_topic_tools: nodelets that one library holds, each with a program that runs it alone

macro(jsk_nodelet source class executable sources executables)
  list(APPEND ${sources} ${source})
  list(APPEND ${executables} ${executable})
  kg_plugin_executable(${executable} ${class})
endmacro()

macro(jsk_add_nodelet source class executable)
  list(APPEND ${PROJECT_NAME}_NODELETS ${source})
  kg_plugin_executable(${executable} ${class})
endmacro()

# --- autoware_cmake, nav2_common

macro(autoware_ament_auto_package)
endmacro()

macro(autoware_package)
  ament_auto_find_build_dependencies()
endmacro()

macro(autoware_agnocast_wrapper_register_node target)
  rclcpp_components_register_node(${target} ${ARGN})
endmacro()
