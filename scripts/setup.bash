# What threelink needs from the machine, and installing what is missing. Sourced by ../threelink.

package_state=/var/lib/dpkg/status

# ROS of packages.ros.org (Ubuntu 20.04, Noetic) or of ROS One; empty where the system brings ROS 1.
ros_prefix=
for ros_distro in noetic one; do
  if [[ -e /opt/ros/$ros_distro/setup.bash ]]; then
    ros_prefix=/opt/ros/$ros_distro
    break
  fi
done

if [[ -n $ros_prefix ]]; then # its ros-base holds more than Debian's
  ros_packages=(
    "ros-$ros_distro-"{ros-base,rostest,tf2-ros,diagnostic-updater,robot-state-publisher}
    "ros-$ros_distro-"{nav,sensor,tf2,visualization}-msgs
    "ros-$ros_distro-"{actionlib,interactive-markers,pluginlib}  # tasks
    liburdfdom-tools                                      # tests
  )
  # Ubuntu 20.04 has no CLI11: the build gets it.
  if [[ $ros_distro != noetic ]]; then ros_packages+=(libcli11-dev); fi
  rviz_packages=("ros-$ros_distro-rviz" libgl1-mesa-dri)
  clang_packages=(clang llvm clang-format clang-tidy)     # 10 on Ubuntu 20.04, with its sanitizers
else # Debian 12 brings ROS 1 itself
  ros_packages=(
    catkin ros-base rosbash                               # catkin_make, roscpp, rospy, rosrun
    python3-ros{launch,bag,test} librostest-dev           # launching, recording, testing
    ros-{std,geometry,nav,sensor,visualization,rosgraph,diagnostic}-msgs
    lib{std,geometry,nav,sensor,visualization,ros-rosgraph,diagnostic}-msgs-dev
    python3-{geometry,nav,sensor,visualization,diagnostic}-msgs # rostopic echo
    libtf2-ros-dev ros-robot-state-publisher              # frames of the swimmer's links
    libdiagnostic-updater-dev
    librosbag-dev libtopic-tools-dev                      # recording with our own node
    libactionlib-dev ros-actionlib-msgs libactionlib-msgs-dev # tasks: the action,
    python3-actionlib python3-actionlib-msgs
    pluginlib-dev libinteractive-markers-dev              # plug-ins, and what is dragged in rviz
    libtorch-dev                                          # train --backend libtorch
    libcli11-dev                                          # options of the tools
    python3-tf2-ros liburdfdom-tools                      # tests
  )
  rviz_packages=(rviz libgl1-mesa-dri)
  clang_packages=(clang llvm libclang-rt-dev clang-format clang-tidy)
fi
packages=(
  g++ make cmake git                                      # git: bags name the revision
  "${ros_packages[@]}"
  libopenblas0-pthread                                    # without it LibTorch is six times slower
  libeigen3-dev libfmt-dev libssl-dev libyaml-cpp-dev nlohmann-json3-dev
  pkg-config libnlopt-dev libnlopt-cxx-dev                # optimal strokes
  libpng-dev                                              # maps
  libgtest-dev                                            # tests
  python3-numpy python3-matplotlib ffmpeg                 # pictures, movies
  iproute2                                                # workers on other machines, tests of them
)
check_packages=("${clang_packages[@]}" shellcheck python3-pyflakes) # sanitizers, fuzzers, linters
if ! getent hosts localhost >/dev/null; then # a machine without /etc/hosts; ROS looks it up
  packages+=(libnss-myhostname)
fi

missing() { # PACKAGE...: those that are not installed, a line each
  local installed package
  installed=$(dpkg-query -W -f '${db:Status-Status} ${Package}\n' "$@" 2>/dev/null || true)
  for package; do
    if [[ $'\n'$installed$'\n' != *$'\n'"installed $package"$'\n'* ]]; then echo "$package"; fi
  done
}

install_missing() { # PACKAGE...
  if ! command -v dpkg-query >/dev/null; then
    say "this is not a Debian system, so nothing is installed; the build will tell what it misses"
    return
  fi
  local wanted privileged=()
  wanted=$(missing "$@")
  if [[ -z $wanted ]]; then return; fi

  # shellcheck disable=SC2206 # a word each
  local install=(apt-get install -y --no-install-recommends $wanted)
  say "these Debian packages are missing (ROS 1, compiler, libraries):"
  fold -s -w 96 <<<"${wanted//$'\n'/ }" | sed 's/^/  /' >&2
  if ((EUID)); then
    if ! command -v sudo >/dev/null; then
      die "that needs root, and there is no sudo. As root: apt-get update && ${install[*]}"
    fi
    say "apt-get installs them now; sudo is used for this step only"
    sudo -v || die "sudo refused. As root: apt-get update && ${install[*]}"
    privileged=(sudo)
  else
    say "apt-get installs them now"
  fi
  privileged+=(env DEBIAN_FRONTEND=noninteractive)
  quietly "apt-get update" "$root/build/apt-update.log" "${privileged[@]}" apt-get update
  quietly "apt-get install" "$root/build/apt-install.log" \
    "${privileged[@]}" "${install[@]}" -o DPkg::Lock::Timeout=300
}
