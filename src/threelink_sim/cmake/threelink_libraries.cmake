# The libraries that all packages use, under one name each whatever a distribution calls them:
# CLI11::CLI11, fmt::fmt, nlohmann_json::nlohmann_json, yaml-cpp::yaml-cpp.
find_package(fmt REQUIRED)
find_package(nlohmann_json REQUIRED)

# Before 0.8 yaml-cpp exports `yaml-cpp`, from 0.10 on only `yaml-cpp::yaml-cpp`.
find_package(yaml-cpp REQUIRED)
if(NOT TARGET yaml-cpp::yaml-cpp)
  add_library(yaml-cpp::yaml-cpp INTERFACE IMPORTED)
  set_target_properties(yaml-cpp::yaml-cpp PROPERTIES INTERFACE_LINK_LIBRARIES yaml-cpp)
endif()

# Ubuntu 20.04 has no package of CLI11, which is headers only.
if(NOT TARGET CLI11::CLI11)
  find_package(CLI11 QUIET)
endif()
if(NOT TARGET CLI11::CLI11)
  message(STATUS "CLI11 is not installed: getting release 2.4.1 from github.com "
    "(without a network: -DFETCHCONTENT_SOURCE_DIR_CLI11=FOLDER)")
  include(FetchContent)
  FetchContent_Declare(cli11
    GIT_REPOSITORY https://github.com/CLIUtils/CLI11.git
    GIT_TAG f4d0731cebb123ff0ace712c099dffbcd2c58e5a) # v2.4.1
  FetchContent_GetProperties(cli11)
  if(NOT cli11_POPULATED)
    FetchContent_Populate(cli11)
    add_subdirectory(${cli11_SOURCE_DIR} ${cli11_BINARY_DIR} EXCLUDE_FROM_ALL)
  endif()
endif()
