// The camera of a closed loop: which frames of a recording it delivers, when they come in simulated
// time, and what becomes of a frame that finds the front end busy.
//
// Models: a camera with a double buffer. The front end owns one buffer from the start of a frame
// until its pose is out; the camera fills the other one. What the camera does when a frame is ready
// and the front end is still busy is the deadline's policy.
// A rate below the recorded one takes every (recorded/asked)-th frame, rounded to the nearest where
// that is no whole number; the frames then come at even intervals, as of a camera of that rate, and
// each picture is up to half a recorded period older or younger than its arrival. The estimator is
// given the time at which the picture was taken, so that its IMU samples fit it.
//
// Leaves out: exposure and readout (a frame is there in an instant, and with it the IMU samples up
// to it), and that the front end could give its buffer back once features are extracted.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "sim/base/units.h"

namespace leviosim::soc {

/// What becomes of a frame that finds the front end busy.
enum class Deadline : std::uint8_t {
  Drop,   ///< it is lost
  Queue,  ///< it waits in its buffer; the next one, which finds no buffer, is lost
};

struct DeadlineInfo {
  Deadline deadline;
  std::string_view name;
  int capacity;  ///< frames taken and not finished at which a further one is lost
  std::string_view description;
};
inline constexpr std::array kDeadlines{
    DeadlineInfo{Deadline::Drop, "drop", 1, "a frame that finds the front end busy is dropped"},
    DeadlineInfo{
        Deadline::Queue, "queue", 2,
        "a frame that finds the front end busy waits; while one waits, others are dropped"},
};

const DeadlineInfo& info_of(Deadline deadline);
/// @throws InputError with the nearest valid name
Deadline parse_deadline(const std::string& text);

/// What the second buffer takes in L2; the first one is part of what the workload keeps there.
inline Bytes second_buffer(int width, int height) { return Bytes(std::int64_t{width} * height); }

struct CameraRequest {
  std::optional<double> fps;  ///< the recording's if absent
  Deadline deadline = Deadline::Drop;
};

/// A frame as the camera delivers it.
struct CameraFrame {
  std::size_t recorded = 0;     ///< which of the recording
  std::int64_t arrival_ns = 0;  ///< simulated time since the first
};

/// All frames of the recording, at their stamps.
std::vector<CameraFrame> all_frames(const std::vector<std::int64_t>& stamps_ns);

/// Those of a camera of `fps` frames per second.
/// @param stamps_ns    of the recorded frames, not empty
/// @param recorded_hz  nominal rate of the recording
/// @throws InputError for a rate above that: there is nothing between two recorded frames
std::vector<CameraFrame> frames_at(double fps, const std::vector<std::int64_t>& stamps_ns,
                                   double recorded_hz);

/// What became of a frame when it arrived.
struct Delivery {
  int frame = 0;          ///< number among the camera's frames, from 0
  std::int64_t t_ns = 0;  ///< time stamp of the picture
  std::int64_t arrival_ns = 0;
  int found = 0;  ///< frames that it found in the buffers, in work or waiting
  bool dropped = false;
};

/// The camera's side of a run in a closed loop.
struct CameraRecord {
  double fps = 0;
  Deadline deadline = Deadline::Drop;
  std::vector<Delivery> deliveries;
};

}  // namespace leviosim::soc
