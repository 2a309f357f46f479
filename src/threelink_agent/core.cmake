# The parts of this package that know no ROS; with catkin and without it (../cores/CMakeLists.txt).
find_package(Threads REQUIRED)
find_package(Torch QUIET)

# Core: policies, their files and their measures; knows neither ROS nor LibTorch.
add_library(threelink_agent_core
  ${CMAKE_CURRENT_LIST_DIR}/src/core/actor.cpp
  ${CMAKE_CURRENT_LIST_DIR}/src/core/container_fields.cpp
  ${CMAKE_CURRENT_LIST_DIR}/src/core/evaluate.cpp
  ${CMAKE_CURRENT_LIST_DIR}/src/core/mlp.cpp
  ${CMAKE_CURRENT_LIST_DIR}/src/core/network_kernels.cpp
  ${CMAKE_CURRENT_LIST_DIR}/src/core/packed.cpp
  ${CMAKE_CURRENT_LIST_DIR}/src/core/policy.cpp
  ${CMAKE_CURRENT_LIST_DIR}/src/core/policy_file.cpp
  ${CMAKE_CURRENT_LIST_DIR}/src/core/safetensors.cpp
)
threelink_add_kernels(threelink_agent_core ${CMAKE_CURRENT_LIST_DIR}/src/kernel/network_kernels)
target_include_directories(threelink_agent_core PUBLIC ${CMAKE_CURRENT_LIST_DIR}/include)
target_link_libraries(threelink_agent_core
  PUBLIC threelink_sim_core
  PRIVATE fmt::fmt nlohmann_json::nlohmann_json)

# Training, without LibTorch. It is not among catkin's LIBRARIES: a robot needs none of it.
add_library(threelink_agent_training
  ${CMAKE_CURRENT_LIST_DIR}/src/training/advantage.cpp
  ${CMAKE_CURRENT_LIST_DIR}/src/training/checkpoint.cpp
  ${CMAKE_CURRENT_LIST_DIR}/src/training/checkpoint_writer.cpp
  ${CMAKE_CURRENT_LIST_DIR}/src/training/crew.cpp
  ${CMAKE_CURRENT_LIST_DIR}/src/training/exploration_noise.cpp
  ${CMAKE_CURRENT_LIST_DIR}/src/training/fused_network.cpp
  ${CMAKE_CURRENT_LIST_DIR}/src/training/fused_update.cpp
  ${CMAKE_CURRENT_LIST_DIR}/src/training/gradient_kernels.cpp
  ${CMAKE_CURRENT_LIST_DIR}/src/training/learner_state.cpp
  ${CMAKE_CURRENT_LIST_DIR}/src/training/metrics_file.cpp
  ${CMAKE_CURRENT_LIST_DIR}/src/training/minibatches.cpp
  ${CMAKE_CURRENT_LIST_DIR}/src/training/rollout.cpp
  ${CMAKE_CURRENT_LIST_DIR}/src/training/rollout_source.cpp
  ${CMAKE_CURRENT_LIST_DIR}/src/training/run_folder.cpp
  ${CMAKE_CURRENT_LIST_DIR}/src/training/samples.cpp
  ${CMAKE_CURRENT_LIST_DIR}/src/training/run_lock.cpp
  ${CMAKE_CURRENT_LIST_DIR}/src/training/train_config.cpp
  ${CMAKE_CURRENT_LIST_DIR}/src/training/trainer.cpp
)
threelink_add_kernels(threelink_agent_training ${CMAKE_CURRENT_LIST_DIR}/src/kernel/gradient_kernels)
target_link_libraries(threelink_agent_training
  PUBLIC threelink_agent_core
  PRIVATE fmt::fmt Threads::Threads yaml-cpp::yaml-cpp)

# Training over the network, without the network: knows neither ROS nor LibTorch.
add_library(threelink_agent_distributed
  ${CMAKE_CURRENT_LIST_DIR}/src/distributed/dispatcher.cpp
  ${CMAKE_CURRENT_LIST_DIR}/src/distributed/episode_batch.cpp
  ${CMAKE_CURRENT_LIST_DIR}/src/distributed/fingerprint.cpp
  ${CMAKE_CURRENT_LIST_DIR}/src/distributed/lease_book.cpp
  ${CMAKE_CURRENT_LIST_DIR}/src/distributed/lease_player.cpp
  ${CMAKE_CURRENT_LIST_DIR}/src/distributed/live_episode.cpp
  ${CMAKE_CURRENT_LIST_DIR}/src/distributed/remote_rollouts.cpp
  ${CMAKE_CURRENT_LIST_DIR}/src/distributed/worker_roster.cpp
)
target_link_libraries(threelink_agent_distributed
  PUBLIC threelink_agent_training
  PRIVATE fmt::fmt)

# The backends of the update: the only part that knows LibTorch, of which it does without where
# there is none.
add_library(threelink_agent_backends ${CMAKE_CURRENT_LIST_DIR}/src/training/backend.cpp)
target_link_libraries(threelink_agent_backends PUBLIC threelink_agent_training PRIVATE fmt::fmt)
if(Torch_FOUND)
  target_sources(threelink_agent_backends PRIVATE
    ${CMAKE_CURRENT_LIST_DIR}/src/training/blas.cpp
    ${CMAKE_CURRENT_LIST_DIR}/src/training/losses.cpp
    ${CMAKE_CURRENT_LIST_DIR}/src/training/networks.cpp
    ${CMAKE_CURRENT_LIST_DIR}/src/training/optimiser.cpp
    ${CMAKE_CURRENT_LIST_DIR}/src/training/torch_update.cpp
  )
  target_compile_definitions(threelink_agent_backends PUBLIC THREELINK_LIBTORCH)
  target_include_directories(threelink_agent_backends SYSTEM PRIVATE ${TORCH_INCLUDE_DIRS})
  target_link_libraries(threelink_agent_backends
    PRIVATE ${TORCH_LIBRARIES} Threads::Threads ${CMAKE_DL_LIBS})
else()
  message(WARNING "LibTorch was not found: `train --backend libtorch` will not be there")
endif()
