# Common settings of the scripts in this folder, which source this file in the root of the repository.

# Debian's ROS requires Debian's Python.
export PATH=/usr/bin:/bin:$PATH

# Configures a build of all parts. Usage: configure FOLDER [CMAKE ARGUMENTS]. The variable
# CBMV_CMAKE_ARGUMENTS can contain more arguments, separated by blanks.
configure() {
  local folder=$1 extra
  shift
  read -r -a extra <<<"${CBMV_CMAKE_ARGUMENTS:-}"
  cmake -S . -B "$folder" -G Ninja -DCMAKE_BUILD_TYPE=Release \
    -DPYTHON_EXECUTABLE=/usr/bin/python3 -DPython3_EXECUTABLE=/usr/bin/python3 \
    -DCBMV_BUILD_TOOLS=ON -DCBMV_BUILD_TRAINING=ON -DCBMV_DEVELOPER=ON -DBUILD_TESTING=ON \
    "$@" "${extra[@]}"
}

# Prints a free port of 127.0.0.1.
free_port() {
  /usr/bin/python3 -c 'import socket; s = socket.socket(); s.bind(("127.0.0.1", 0)); print(s.getsockname()[1])'
}

# Prints the mirror of Debian that apt uses. Fails if there is none.
debian_mirror() {
  apt-get indextargets --format '$(REPO_URI)' 'Label: Debian' |
    awk 'NR == 1 { print } END { exit NR == 0 }'
}
