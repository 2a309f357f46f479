# `./threelink doctor`: a line for each thing that can go wrong on a machine. Sourced by ../threelink.
# ok: as it should be; note: good to know, nothing is broken; problem: must be cured, with the cure.

problems=0
report() { printf '%-8s %-13s %s\n' "$@"; } # KIND SUBJECT FINDING
ok() { report ok "$@"; }
note() { report note "$@"; }
problem() {
  problems=$((problems + 1))
  report problem "$@"
}

doctor() {
  check_system
  check_packages
  check_processor
  check_blas
  check_ros_environment
  check_master
  check_workspace
  if ((problems)); then
    echo "problems: $problems"
    return 1
  fi
  echo "no problems"
}

check_system() {
  local name
  name=$(sed -n 's/^PRETTY_NAME="\?\([^"]*\)"\?$/\1/p' /etc/os-release)
  case $(sed -n 's/^ID=//p; s/^VERSION_ID="\?\([^"]*\)"\?$/\1/p' /etc/os-release | sort | tr '\n' ' ') in
    "12 debian ") ok system "$name, on which threelink is built and tested" ;;
    "20.04 ubuntu ")
      if [[ $ros_prefix == */noetic ]]; then
        note system "$name with ROS Noetic, prepared: compiled against focal's versions of the libraries, not run"
      else
        problem system "$name without ROS Noetic: install it as wiki.ros.org/noetic/Installation/Ubuntu says"
      fi
      ;;
    *)
      if [[ -n $ros_prefix ]]; then
        note system "$name with $ros_prefix, prepared: never built; threelink is built and tested on Debian 12"
      else
        note system "$name, never tried: threelink is built and tested on Debian 12, package names may differ"
      fi
      ;;
  esac

  local cores memory free
  cores=$(nproc)
  memory=$(awk '/^MemAvailable/ { printf "%.1f", $2 / 1e6 }' /proc/meminfo)
  free=$(df -Pk "$root" | awk 'NR == 2 { print int($4 / 1e6) }')
  if ((${memory%.*} < 2)); then
    problem memory "$memory GB available; building needs 2 GB: close programs or add swap"
  else
    ok memory "$memory GB available, $cores cores"
  fi
  if ((free < 1)); then
    problem disk "less than 1 GB free at $root: builds and bags need more"
  else
    ok disk "$free GB free at $root"
  fi
}

check_packages() {
  if ! command -v dpkg-query >/dev/null; then
    note packages "not a Debian system: packages are not checked"
    return
  fi
  local absent
  absent=$(missing "${packages[@]}" | tr '\n' ' ')
  if [[ -n $absent ]]; then
    problem packages "missing: $absent-> ./threelink setup"
  else
    ok packages "all ${#packages[@]} installed"
  fi
  absent=$(missing "${rviz_packages[@]}" | tr '\n' ' ')
  if [[ -n $absent ]]; then
    note rviz "missing: $absent-> ./threelink setup rviz, or the first pursuit with rviz:=true"
  elif [[ -z ${DISPLAY:-} ]]; then
    note rviz "installed, but DISPLAY is not set: pursuit runs without it"
  else
    ok rviz "installed, display $DISPLAY"
  fi

  local tool
  for tool in g++ cmake /usr/bin/python3; do
    if command -v "$tool" >/dev/null; then ok "${tool##*/}" "$("$tool" --version | head -n 1)"; fi
  done
  if [[ $callers_python != /usr/bin/python3 && -n $callers_python ]]; then
    note python3 "your PATH has $callers_python first; ROS needs /usr/bin/python3, which threelink uses"
  fi
}

check_processor() {
  local kernel=baseline
  if runs avx2 fma; then kernel=avx2; fi
  if runs avx2 fma avx512f avx512dq avx512bw avx512vl; then kernel=avx512; fi
  if [[ -n ${THREELINK_ISA:-} ]]; then
    note processor "widest kernel is $kernel, but THREELINK_ISA=$THREELINK_ISA is what counts"
  elif [[ $kernel == baseline ]]; then
    note processor "no AVX2 with FMA: baseline kernel, slow, and its results may differ in the last bits"
  else
    ok processor "$kernel kernel"
  fi
}

runs() { # FLAG...: whether the processor has all of these
  local flags flag
  flags=" $(sed -n '/^flags/ { s/.*: //p; q }' /proc/cpuinfo) "
  for flag; do [[ $flags == *" $flag "* ]] || return 1; done
}

check_blas() {
  local torch blas
  torch=$(find /usr/lib -name libtorch_cpu.so 2>/dev/null | head -n 1)
  if [[ -z $torch ]]; then
    note LibTorch "not found: only \`train --backend libtorch\` needs it"
    return
  fi
  blas=$(ldd "$torch" | awk '/libblas/ { print $3 }')
  blas=$(readlink -f "${blas:-none}")
  if [[ $blas == *openblas* ]]; then
    ok LibTorch "its BLAS is $blas"
  else
    problem LibTorch "its BLAS is $blas, six times slower than OpenBLAS -> apt-get install libopenblas0-pthread," \
      "then update-alternatives --auto libblas.so.3-$(uname -m)-linux-gnu"
  fi
}

check_ros_environment() {
  local version
  version=$(sed -n 's:.*<version>\(.*\)</version>.*:\1:p' {"$ros_prefix",/usr}/share/roscpp/package.xml 2>/dev/null || true)
  if [[ -n $version ]]; then ok ROS "roscpp $version"; else problem ROS "not found -> ./threelink setup"; fi
  if [[ ${ROS_VERSION:-1} == 2 || -n ${AMENT_PREFIX_PATH:-} ]]; then
    problem ROS "ROS 2 (${ROS_DISTRO:-?}) is sourced in this shell: use one where it is not"
  fi

  local host=${ROS_HOSTNAME:-} address=${ROS_IP:-}
  if [[ -n $host && -n $address ]]; then
    note ROS_HOSTNAME "is $host and wins over ROS_IP=$address: set only one of them"
  fi
  if [[ -n $host ]]; then
    if getent hosts "$host" >/dev/null; then
      ok ROS_HOSTNAME "$host"
    else
      problem ROS_HOSTNAME "$host does not resolve: nodes cannot reach each other -> unset it"
    fi
  elif [[ -n $address ]]; then
    if grep -qE "[^0-9.]${address//./\\.}( |\$)" /proc/net/fib_trie; then
      ok ROS_IP "$address"
    else
      problem ROS_IP "$address is not an address of this machine -> unset it"
    fi
  fi
}

check_master() {
  local uri=${ROS_MASTER_URI:-} host=127.0.0.1 port=11311
  if [[ $uri =~ ^http://([^:/]+):([0-9]+)/?$ ]]; then
    host=${BASH_REMATCH[1]} port=${BASH_REMATCH[2]}
  elif [[ -n $uri ]]; then
    problem ROS_MASTER_URI "$uri is not of the form http://HOST:PORT"
    return
  fi
  # shellcheck disable=SC2016 # expanded by that bash
  if ! timeout 2 bash -c 'exec 3<>"/dev/tcp/$0/$1"' "$host" "$port" 2>/dev/null; then
    if [[ -z $uri || $host =~ ^(localhost|127\.) ]]; then
      ok master "none runs on port $port; pursuit starts its own"
    else
      problem master "nothing answers at ROS_MASTER_URI=$uri -> start a roscore there, or unset it"
    fi
  elif [[ -z $uri ]]; then
    ok master "port $port is in use; pursuit takes the next free one"
  elif ROS_MASTER_URI=$uri timeout 5 rostopic info /clock 2>/dev/null | grep -q '^Publishers: *$'; then
    problem master "at $uri somebody publishes /clock already: a second simulator must not -> unset ROS_MASTER_URI"
  else
    note master "one runs at ROS_MASTER_URI=$uri; pursuit joins it"
  fi
}

check_workspace() {
  if up_to_date; then
    ok workspace "built"
  else
    note workspace "not built, or older than its sources: any command that needs it builds it"
  fi
}
