# The parts of this package that know no ROS; with catkin and without it (../cores/CMakeLists.txt).
find_package(Eigen3 REQUIRED)
find_package(OpenSSL REQUIRED)
find_package(PkgConfig REQUIRED)
find_package(PNG REQUIRED)
pkg_check_modules(NLOPT REQUIRED IMPORTED_TARGET nlopt)

# Core: physics, environment, tasks and goals, and guarded files in and out; knows no ROS.
add_library(threelink_sim_core
  ${CMAKE_CURRENT_LIST_DIR}/src/core/batch.cpp
  ${CMAKE_CURRENT_LIST_DIR}/src/core/csv.cpp
  ${CMAKE_CURRENT_LIST_DIR}/src/core/environment.cpp
  ${CMAKE_CURRENT_LIST_DIR}/src/core/excerpt.cpp
  ${CMAKE_CURRENT_LIST_DIR}/src/core/fields.cpp
  ${CMAKE_CURRENT_LIST_DIR}/src/core/files.cpp
  ${CMAKE_CURRENT_LIST_DIR}/src/core/isa.cpp
  ${CMAKE_CURRENT_LIST_DIR}/src/core/json.cpp
  ${CMAKE_CURRENT_LIST_DIR}/src/core/kernels.cpp
  ${CMAKE_CURRENT_LIST_DIR}/src/core/lockstep.cpp
  ${CMAKE_CURRENT_LIST_DIR}/src/core/observation.cpp
  ${CMAKE_CURRENT_LIST_DIR}/src/core/model.cpp
  ${CMAKE_CURRENT_LIST_DIR}/src/core/output.cpp
  ${CMAKE_CURRENT_LIST_DIR}/src/core/parameter_map.cpp
  ${CMAKE_CURRENT_LIST_DIR}/src/core/random.cpp
  ${CMAKE_CURRENT_LIST_DIR}/src/core/range.cpp
  ${CMAKE_CURRENT_LIST_DIR}/src/core/sha256.cpp
  ${CMAKE_CURRENT_LIST_DIR}/src/core/stroke.cpp
  ${CMAKE_CURRENT_LIST_DIR}/src/core/stroke_file.cpp
  ${CMAKE_CURRENT_LIST_DIR}/src/core/stroke_period.cpp
  ${CMAKE_CURRENT_LIST_DIR}/src/core/swimmer.cpp
  ${CMAKE_CURRENT_LIST_DIR}/src/core/urdf.cpp
  ${CMAKE_CURRENT_LIST_DIR}/src/core/utf8.cpp
  ${CMAKE_CURRENT_LIST_DIR}/src/core/yaml.cpp
  ${CMAKE_CURRENT_LIST_DIR}/src/goal/goals.cpp
  ${CMAKE_CURRENT_LIST_DIR}/src/goal/points_goal.cpp
  ${CMAKE_CURRENT_LIST_DIR}/src/goal/task_goal.cpp
  ${CMAKE_CURRENT_LIST_DIR}/src/task/basic_task.cpp
  ${CMAKE_CURRENT_LIST_DIR}/src/task/capture.cpp
  ${CMAKE_CURRENT_LIST_DIR}/src/task/clicked_point_task.cpp
  ${CMAKE_CURRENT_LIST_DIR}/src/task/direction_task.cpp
  ${CMAKE_CURRENT_LIST_DIR}/src/task/path_task.cpp
  ${CMAKE_CURRENT_LIST_DIR}/src/task/point_file.cpp
  ${CMAKE_CURRENT_LIST_DIR}/src/task/point_task.cpp
  ${CMAKE_CURRENT_LIST_DIR}/src/task/pursuit_task.cpp
  ${CMAKE_CURRENT_LIST_DIR}/src/task/task.cpp
  ${CMAKE_CURRENT_LIST_DIR}/src/task/task_factory.cpp
  ${CMAKE_CURRENT_LIST_DIR}/src/task/waypoints_task.cpp
  ${CMAKE_CURRENT_LIST_DIR}/src/world/contact.cpp
  ${CMAKE_CURRENT_LIST_DIR}/src/world/flow_set.cpp
  ${CMAKE_CURRENT_LIST_DIR}/src/world/grid_file.cpp
  ${CMAKE_CURRENT_LIST_DIR}/src/world/map_file.cpp
  ${CMAKE_CURRENT_LIST_DIR}/src/world/obstacles.cpp
  ${CMAKE_CURRENT_LIST_DIR}/src/world/random_modes.cpp
  ${CMAKE_CURRENT_LIST_DIR}/src/world/world.cpp
  ${CMAKE_CURRENT_LIST_DIR}/src/world/world_stepper.cpp
)
threelink_add_kernels(threelink_sim_core ${CMAKE_CURRENT_LIST_DIR}/src/kernel/kernels)
threelink_add_kernels(threelink_sim_core ${CMAKE_CURRENT_LIST_DIR}/src/kernel/world_kernels)
target_include_directories(threelink_sim_core PUBLIC ${CMAKE_CURRENT_LIST_DIR}/include PRIVATE ${EIGEN3_INCLUDE_DIRS})
target_link_libraries(threelink_sim_core
  PUBLIC Eigen3::Eigen fmt::fmt nlohmann_json::nlohmann_json yaml-cpp::yaml-cpp
  PRIVATE OpenSSL::Crypto PNG::PNG)

# Strokes: the search for optimal ones, which alone needs NLopt.
add_library(threelink_sim_strokes
  ${CMAKE_CURRENT_LIST_DIR}/src/core/optimal_stroke.cpp
  ${CMAKE_CURRENT_LIST_DIR}/src/core/stroke_climb.cpp
  ${CMAKE_CURRENT_LIST_DIR}/src/core/stroke_gradient.cpp
  ${CMAKE_CURRENT_LIST_DIR}/src/core/stroke_problem.cpp
)
set_source_files_properties(${CMAKE_CURRENT_LIST_DIR}/src/core/stroke_gradient.cpp PROPERTIES
  COMPILE_OPTIONS "-O3;-fno-math-errno;-fno-trapping-math")
target_link_libraries(threelink_sim_strokes
  PUBLIC threelink_sim_core
  PRIVATE fmt::fmt PkgConfig::NLOPT)
