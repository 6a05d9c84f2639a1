#!/usr/bin/env bash
# A motion of three laps, for flights that come back: tools/laps_motion.sh MOTION OUT writes an ASL folder with ground truth and the
# sensors of the ASL folder MOTION, to be drawn with `leviosim synth --motion OUT --imu simulated`.
#
# Two seconds at rest, then an ellipse of 10 m by 6 m at 0.8 m/s, looking ahead, shaken by 3 cm and 2 degrees as by a hand.
# The body's axes are EuRoC's: x up, z forward.
set -euo pipefail

motion=${1:?usage: tools/laps_motion.sh MOTION OUT}
out=${2:?usage: tools/laps_motion.sh MOTION OUT}
for sensor in cam0 imu0; do
  if [[ ! -f $motion/mav0/$sensor/sensor.yaml ]]; then
    echo "laps_motion.sh: $motion/mav0/$sensor/sensor.yaml is missing" >&2
    exit 2
  fi
done
if [[ -e $out ]]; then
  echo "laps_motion.sh: $out exists already" >&2
  exit 2
fi

whole=$out
out=$(mktemp -d "$whole.XXXXXX")
trap 'rm -rf "$out"' EXIT
mkdir -p "$out/mav0/cam0" "$out/mav0/imu0" "$out/mav0/state_groundtruth_estimate0"
for sensor in cam0 imu0; do cp "$motion/mav0/$sensor/sensor.yaml" "$out/mav0/$sensor/"; done

LC_ALL=C awk '
function smooth(x) { return x <= 0 ? 0 : x >= 1 ? 1 : x * x * (3 - 2 * x) }
# The quaternion of a turn by an angle about x, y or z, times q.
function turn(axis, angle,   c, s, w, x, y, z) {
  c = cos(angle / 2); s = sin(angle / 2); w = q[0]; x = q[1]; y = q[2]; z = q[3]
  if (axis == 1) { q[0] = c*w - s*x; q[1] = c*x + s*w; q[2] = c*y - s*z; q[3] = c*z + s*y }
  if (axis == 2) { q[0] = c*w - s*y; q[1] = c*x + s*z; q[2] = c*y + s*w; q[3] = c*z - s*x }
  if (axis == 3) { q[0] = c*w - s*z; q[1] = c*x - s*y; q[2] = c*y + s*x; q[3] = c*z + s*w }
}
BEGIN {
  pi = atan2(0, -1); a = 5; b = 3; dt = 0.005; angle = 0
  print "#timestamp, p_RS_R_x [m], p_RS_R_y [m], p_RS_R_z [m], q_RS_w [], q_RS_x [], q_RS_y [], q_RS_z [], v_RS_R_x [m s^-1], v_RS_R_y [m s^-1], v_RS_R_z [m s^-1], b_w_RS_S_x [rad s^-1], b_w_RS_S_y [rad s^-1], b_w_RS_S_z [rad s^-1], b_a_RS_S_x [m s^-2], b_a_RS_S_y [m s^-2], b_a_RS_S_z [m s^-2]"
  for (i = 0; angle < 6 * pi; ++i) {
    t = i * dt; on = smooth((t - 2) / 2)
    x = a * cos(angle) + on * 0.03 * sin(6.1 * t)
    y = b * sin(angle) + on * 0.03 * sin(7.3 * t + 1)
    z = 1.5 + on * (0.2 * sin(angle) + 0.03 * sin(8.2 * t + 2))
    heading = atan2(b * cos(angle), -a * sin(angle))
    while (heading < last_heading - pi) heading += 2 * pi
    last_heading = heading
    # From x up, z forward along the x axis of the world; y is then to the right.
    q[0] = sqrt(0.5); q[1] = 0; q[2] = -sqrt(0.5); q[3] = 0
    turn(3, pi)
    turn(1, on * 0.035 * sin(5.3 * t)); turn(2, on * 0.035 * sin(4.4 * t + 0.5))
    turn(3, heading + on * 0.035 * sin(3.7 * t + 1.5))
    vx = i ? (x - last_x) / dt : 0; vy = i ? (y - last_y) / dt : 0; vz = i ? (z - last_z) / dt : 0
    last_x = x; last_y = y; last_z = z
    printf "%d%09d,%.6f,%.6f,%.6f,%.8f,%.8f,%.8f,%.8f,%.6f,%.6f,%.6f,0,0,0,0,0,0\n",
           1000 + int(i / 200), 5000000 * (i % 200), x, y, z, q[0], q[1], q[2], q[3], vx, vy, vz
    angle += on * 0.8 * dt / sqrt(a * a * sin(angle) ^ 2 + b * b * cos(angle) ^ 2)
  }
}' >"$out/mav0/state_groundtruth_estimate0/data.csv"
chmod 755 "$out"
mv -T "$out" "$whole"
