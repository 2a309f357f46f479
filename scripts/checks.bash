# The checks beside the tests: sanitizers, fuzzers, linters, API pages. Sourced by ../threelink.

checked=$root/build/sanitize-address  # address and undefined behaviour; the fuzzers share this build
raced=$root/build/sanitize-thread     # data races
suppressions=$root/tests/sanitizers   # findings in libraries of others

export ASAN_OPTIONS=detect_stack_use_after_return=1:strict_string_checks=1:detect_leaks=1
export LSAN_OPTIONS=suppressions=$suppressions/leaks.supp:print_suppressions=0
export UBSAN_OPTIONS=print_stacktrace=1
export TSAN_OPTIONS=halt_on_error=1:second_deadlock_stack=1:suppressions=$suppressions/races.supp

configure_checked() { # FOLDER SANITIZERS OPTION...: a build by clang in a folder of its own
  local folder=$1 sanitizers=$2
  shift 2
  install_missing "${packages[@]}" "${check_packages[@]}"
  if [[ -n $ros_prefix ]]; then source_ros "$ros_prefix/setup.bash"; fi
  quietly "configuring ${folder#"$root/"}" "$folder/configure.log" \
    cmake -S "$root/src" -B "$folder" -DCMAKE_C_COMPILER=clang -DCMAKE_CXX_COMPILER=clang++ \
    -DTHREELINK_SANITIZE="$sanitizers" -DCATKIN_DEVEL_PREFIX="$folder/devel" \
    -DCMAKE_EXPORT_COMPILE_COMMANDS=ON "$@"
}

configure_address() { configure_checked "$checked" address,undefined -DTHREELINK_FUZZ=ON; }

make_checked() { # FOLDER TARGET...
  quietly "building ${*:2} with sanitizers" "$1/build.log" \
    setsid make -C "$1" --no-print-directory -j "$(jobs_at_once)" "${@:2}"
}

# --- Tests under sanitizers ----------------------------------------------------------------------

run_sanitized() { # FOLDER LABEL: the tests of that label; the last line counts them
  cd "$1" || return
  rm -rf test_results Testing
  local status=0
  source_ros devel/setup.bash
  attend setsid ctest -L "$2" -j "$(jobs_at_once)" --output-on-failure --timeout 900 || status=$?
  exec /usr/bin/python3 "$root/scripts/test_results.py" "$PWD" "$status"
}

test_sanitized() { # address, thread or both
  unset ROS_MASTER_URI
  case $1 in
    address)
      configure_address
      make_checked "$checked" unit_tests
      run_sanitized "$checked" unit
      ;;
    thread)
      # Without LibTorch, which is built without ThreadSanitizer, and whose threads are its own.
      configure_checked "$raced" thread -DCMAKE_DISABLE_FIND_PACKAGE_Torch=ON
      make_checked "$raced" threaded_tests
      run_sanitized "$raced" threads
      ;;
    both)
      tally test --sanitize=address
      tally test --sanitize=thread
      end_tally
      ;;
  esac
}

# --- The cores alone -----------------------------------------------------------------------------

# What knows no ROS, by plain CMake. Without LibTorch, too; and without optimising much, since bits do not
# depend on that.
test_cores() {
  local folder=$root/build/cores status=0
  install_missing "${packages[@]}"
  quietly "configuring build/cores" "$folder/configure.log" \
    cmake -S "$root/src/cores" -B "$folder" -DCMAKE_BUILD_TYPE=None -DCMAKE_CXX_FLAGS=-O1 \
    -DCMAKE_DISABLE_FIND_PACKAGE_Torch=ON
  quietly "building the cores without ROS" "$folder/build.log" \
    setsid make -C "$folder" --no-print-directory -j "$(jobs_at_once)"
  rm -rf "$folder/test_results" "$folder/Testing"
  cd "$folder" || return
  GTEST_OUTPUT=xml:$folder/test_results/ \
    attend setsid ctest -j "$(jobs_at_once)" --output-on-failure --timeout 900 || status=$?
  exec /usr/bin/python3 "$root/scripts/test_results.py" "$PWD" "$status"
}

# --- Fuzzers and linters -------------------------------------------------------------------------

fuzz() { # [--seed=N] [SECONDS [NAME...]]
  local seed=0
  if [[ ${1:-} == --seed=* ]]; then
    seed=${1#--seed=}
    shift
    if [[ ! $seed =~ ^[0-9]{1,9}$ ]]; then misused "fuzz --seed=$seed: the seed must be a whole number"; fi
  fi
  local seconds=${1:-20}
  if [[ ! $seconds =~ ^[1-9][0-9]{0,5}$ ]]; then
    misused "fuzz $seconds: the seconds for each reader must be a whole number from 1 on"
  fi
  local name
  for name in "${@:2}"; do
    if [[ ! -e $root/tests/fuzz/${name}_fuzz.cpp ]]; then misused "fuzz: there is no reader \`$name\`"; fi
  done
  configure_address
  make_checked "$checked" fuzzers
  attend setsid /usr/bin/python3 "$root/scripts/fuzz.py" \
    "$checked/fuzzers" "$(jobs_at_once)" "$seconds" "$seed" "${@:2}"
}

lint() { # [--brief]
  configure_address
  make_checked "$checked" generated_headers
  attend setsid /usr/bin/python3 "$root/scripts/lint.py" "$checked" "$(jobs_at_once)" "$@"
}

# --- API pages -----------------------------------------------------------------------------------

docs() { # needs neither a build nor the workspace's packages
  install_missing python3 doxygen
  attend /usr/bin/python3 "$root/scripts/docs.py" "$root"
}

# --- All of them ---------------------------------------------------------------------------------

check() { # [--brief]: all parts run, whatever comes of the others
  tally test
  tally test --cores
  if [[ ${1:-} == --brief ]]; then
    tally test --sanitize=thread
    tally lint --brief
  else
    tally test --sanitize
    tally fuzz 20
    tally lint
    tally docs
  fi
  end_tally
}

passed=0 failed=0 skipped=0

tally() { # COMMAND...: runs `threelink COMMAND...` and adds up its last line; without one it failed
  local folder last status=0
  folder=$(mktemp -d)
  mkfifo "$folder/pipe"
  tee "$folder/output" <"$folder/pipe" &
  attend "$root/threelink" "$@" >"$folder/pipe" || status=$?
  wait
  last=$(tail -n 1 "$folder/output")
  rm -r "$folder"
  if [[ $last =~ ^([0-9]+)\ passed,\ ([0-9]+)\ failed(,\ ([0-9]+)\ skipped)?$ ]]; then
    passed=$((passed + BASH_REMATCH[1]))
    failed=$((failed + BASH_REMATCH[2]))
    skipped=$((skipped + ${BASH_REMATCH[4]:-0}))
    if ((status == 0 || BASH_REMATCH[2] > 0)); then return; fi
  fi
  echo "FAILED threelink $*: status $status"
  failed=$((failed + 1))
}

end_tally() {
  local line="$passed passed, $failed failed"
  if ((skipped)); then line+=", $skipped skipped"; fi
  echo "$line"
  ((passed > 0 && failed == 0))
}
