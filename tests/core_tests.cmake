# The gtests of what knows no ROS; with catkin and without it (../src/cores/CMakeLists.txt).

# threelink_sim
foreach(name batch_test capture_test contact_test fields_test files_test flow_test lockstep_test
    observation_test output_test point_file_test random_test stroke_period_test swimmer_reference_test swimmer_test
    text_formats_test thermal_test world_file_test)
  threelink_unit_test(${name} threelink_sim_core)
endforeach()
foreach(name optimal_stroke_test stroke_test)
  threelink_unit_test(${name} threelink_sim_strokes)
endforeach()

# threelink_agent, without training
foreach(name evaluate_test mlp_test policy_test safetensors_test)
  threelink_unit_test(${name} threelink_agent_core)
endforeach()

# threelink_tasks
foreach(name bag_name_test environment_test episode_test trials_test)
  threelink_unit_test(${name} threelink_tasks_core)
endforeach()
target_include_directories(bag_name_test PRIVATE
  ${CMAKE_CURRENT_LIST_DIR}/../src/threelink_tasks/src/core)

# Training
foreach(name advantage_test checkpoint_test crew_test fused_update_test gradient_kernels_test
    points_goal_test rollout_test run_folder_test shipped_policies_test train_config_test
    trainer_test)
  threelink_unit_test(${name} threelink_agent_backends)
endforeach()

# Distributed training
threelink_unit_test(live_episode_test threelink_agent_distributed)
foreach(name dispatcher_test dispatcher_strangers_test)
  threelink_unit_test(${name} threelink_agent_distributed threelink_agent_backends)
endforeach()
