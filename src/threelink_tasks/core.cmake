# The parts of this package that know no ROS; with catkin and without it (../cores/CMakeLists.txt).
# Core: whole episodes in one process, and bags; knows no ROS.
add_library(threelink_tasks_core
  ${CMAKE_CURRENT_LIST_DIR}/src/core/bag_name.cpp
  ${CMAKE_CURRENT_LIST_DIR}/src/core/bag_reader.cpp
  ${CMAKE_CURRENT_LIST_DIR}/src/core/bag_record.cpp
  ${CMAKE_CURRENT_LIST_DIR}/src/core/episode.cpp
  ${CMAKE_CURRENT_LIST_DIR}/src/core/play.cpp
  ${CMAKE_CURRENT_LIST_DIR}/src/core/trials.cpp
)
target_link_libraries(threelink_tasks_core
  PUBLIC threelink_agent_core threelink_sim_core Eigen3::Eigen yaml-cpp::yaml-cpp
  PRIVATE fmt::fmt)
target_include_directories(threelink_tasks_core PUBLIC ${CMAKE_CURRENT_LIST_DIR}/include)
