# For the scripts beside it, which source this file in the project's root.

# Debian's ROS works with Debian's Python only.
export PATH=/usr/bin:/bin:$PATH

# Configures a build with everything in it. Usage: configure FOLDER [CMAKE ARGUMENTS]. The variable
# CBMV_CMAKE_ARGUMENTS may hold further arguments, apart by blanks.
configure() {
  local folder=$1 extra
  shift
  read -r -a extra <<<"${CBMV_CMAKE_ARGUMENTS:-}"
  cmake -S . -B "$folder" -G Ninja -DCMAKE_BUILD_TYPE=Release \
    -DPYTHON_EXECUTABLE=/usr/bin/python3 -DPython3_EXECUTABLE=/usr/bin/python3 \
    -DCBMV_BUILD_TOOLS=ON -DCBMV_BUILD_TRAINING=ON -DCBMV_DEVELOPER=ON -DBUILD_TESTING=ON \
    "$@" "${extra[@]}"
}
