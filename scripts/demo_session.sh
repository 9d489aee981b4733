# Functions for scripts that process a real stereo pair with nodes: fetch the pair, run a private ROS master,
# start processes and stop them by their process id. Source this file in the root of the repository.
. scripts/environment.sh

# If a Debian package is not installed, unpacks it into a folder without installing it. Prints the folder
# with its /usr.
unpack_package() {  # PACKAGE FOLDER
  if [ "$(dpkg-query -W -f '${Status}' "$1" 2> /dev/null)" = "install ok installed" ]; then
    return
  fi
  rm -rf "$2" && mkdir -p "$2"
  (cd "$2" && apt-get download -q "$1" > download.log 2>&1 && dpkg-deb -x "$1"_*.deb .) || return 1
  echo "$2"
}

# Gets Middlebury's Motorcycle at quarter resolution (CC0) from the scikit-image package: left.png, right.png,
# truth.pfm and calib.txt in a folder. Source of principal points and baseline: documentation of
# stereo_motorcycle() in scikit-image.
fetch_motorcycle() {  # FOLDER
  local root
  root=$(unpack_package python3-skimage "$1/download") || return 1
  local data=$root/usr/lib/python3/dist-packages/skimage/data
  cp "$data/motorcycle_left.png" "$1/left.png"
  cp "$data/motorcycle_right.png" "$1/right.png"
  /usr/bin/python3 - "$data/motorcycle_disp.npz" "$1/truth.pfm" <<'PYTHON'
import sys
import numpy
truth = numpy.load(sys.argv[1])["arr_0"].astype("<f4")
with open(sys.argv[2], "wb") as pfm:
    pfm.write(b"Pf\n%d %d\n-1\n" % truth.shape[::-1])
    pfm.write(numpy.ascontiguousarray(truth[::-1]).tobytes())
PYTHON
  cat > "$1/calib.txt" <<'CALIBRATION'
cam0=[994.978 0 311.193; 0 994.978 254.877; 0 0 1]
cam1=[994.978 0 342.279; 0 994.978 254.877; 0 0 1]
doffs=31.086
baseline=193.001
width=741
height=500
ndisp=70
CALIBRATION
  rm -rf "$1/download"
}

# Starts a ROS master on a free port of 127.0.0.1 and sources the devel space. Logs go to the folder.
open_session() {  # FOLDER
  session_folder=$1
  set +u  # setup.bash reads variables that may be unset
  . build/devel/setup.bash
  set -u
  local port
  port=$(free_port)
  export ROS_MASTER_URI=http://127.0.0.1:$port ROS_IP=127.0.0.1 ROS_LOG_DIR=$session_folder/log
  unset ROS_HOSTNAME
  trap close_session EXIT
  start roscore roscore -p "$port"
  until rostopic list > /dev/null 2>&1; do sleep 0.2; done
}

session_processes=()
start() {  # LOG COMMAND...: runs the command in the background, with its output in a log
  local log=$1
  shift
  # Restores the default SIGINT handler, because background jobs of a script ignore SIGINT.
  /usr/bin/python3 -c 'import os, signal, sys
signal.signal(signal.SIGINT, signal.SIG_DFL)
os.execvp(sys.argv[1], sys.argv[1:])' "$@" > "$session_folder/$log.log" 2>&1 &
  session_processes+=($!)
}

# Stops all started processes, the last one first.
close_session() {
  local i
  for ((i = ${#session_processes[@]} - 1; i >= 0; i--)); do
    kill -INT "${session_processes[$i]}" 2> /dev/null &&
      wait "${session_processes[$i]}" 2> /dev/null || true
  done
  session_processes=()
}

is_playing() {  # no grep -q, because it closes the pipe early, which kills rosnode
  rosnode list 2> /dev/null | grep /player > /dev/null
}

# Waits until the player, started by process PID, has appeared and ended, or until SECONDS have passed.
wait_for_player() {  # PID SECONDS
  local limit=$((SECONDS + $2))
  until is_playing || ! kill -0 "$1" 2> /dev/null; do sleep 0.2; done
  while [ "$SECONDS" -lt "$limit" ] && is_playing; do sleep 1; done
}

# Starts Xvfb with software OpenGL on a free display.
open_screen() {  # WIDTHxHEIGHT
  start xvfb Xvfb -displayfd 1 -screen 0 "${1}x24" +extension GLX
  local display=
  until display=$(grep -sx '[0-9]\+' "$session_folder/xvfb.log"); do sleep 0.1; done
  export DISPLAY=:$display LIBGL_ALWAYS_SOFTWARE=1
  export XDG_RUNTIME_DIR=$session_folder/runtime
  mkdir -p -m 700 "$XDG_RUNTIME_DIR"
}
