// Flights whose motion was recorded and whose pictures are drawn: the camera of an ASL folder moves
// along that folder's ground truth through a place that is built around the path (hall.h). The IMU
// stream is the recorded one, or simulated along the smoothed path (motion.h); so the
// inertial half of the flight can be real, at full length, without the pictures.
//
// With the recorded IMU, its files and those of the ground truth are copied byte by byte, and
// images are drawn along the exact path. With a simulated one, pictures, IMU and ground truth
// follow the smoothed path. Frames are the recording's (cam0/data.csv) or, without that file, the
// IMU samples nearest to the camera's period; only those within the ground truth, and after a whole
// frame period of IMU samples.
//
// The result is an ASL folder with the camera's full images, or with images that are undistorted
// and decimated already (image_preparation.h) and of which only those pixels were drawn that they
// need. Both give a pipeline the same images.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <vector>

#include "traces/datasets/asl_reader.h"
#include "traces/datasets/dataset.h"
#include "traces/datasets/image_preparation.h"
#include "traces/synthesis/place.h"
#include "traces/synthesis/synthetic.h"

namespace leviosim::traces {

enum class ImuSource { automatic, recorded, simulated };

struct RenderedFlightOptions {
  Place place;                           ///< its seed is also that of light and noise
  std::optional<ImageSize> prepared;     ///< size of the prepared images; absent: full images
  ImuSource imu = ImuSource::automatic;  ///< automatic: recorded if there is a recording
  /// Of the whole flight, one behind the other; all frames if there is none. A frame has the same
  /// picture whichever others are drawn.
  std::vector<FrameRange> frames;
  double exposure_s = 0;      ///< of the motion blur, centred on the stamp; 0: none
  bool illumination = false;  ///< changes with time
  double image_noise = 1.2;   ///< standard deviation [grey levels]; of a workshop more, in light
  double spot_px = 2;         ///< softness of the lens, RenderOptions::spot_px
  double texels = 1;          ///< HallOptions::texels
  unsigned threads = 0;       ///< 0: as many as the host has; the result does not depend on it
  bool overwrite = false;     ///< replace a flight that was written before (sim/base)
  bool repair = false;        ///< also if its files were changed since, as those of a cache may be
};

/// When the frames of the whole flight are taken, which FrameRange counts. [ns] Throws InputError
/// if there is none.
std::vector<std::int64_t> rendered_frame_stamps(const MotionRecord& record,
                                                const RenderedFlightOptions& options = {});

/// Writes `out_dir`/mav0/... from the motion in `motion_dir`. The folder appears under its name
/// only when complete. Throws InputError for input that cannot be used, options out of range, if
/// `out_dir` exists (unless overwrite), holds anything else or `motion_dir`, or cannot be written.
void write_rendered_flight(const std::filesystem::path& motion_dir,
                           const std::filesystem::path& out_dir,
                           const RenderedFlightOptions& options = {},
                           const FlightProgress& progress = {});

// Choosing the times at which a camera takes its frames. All stamps are nanoseconds and rise.

using StampList = std::vector<std::int64_t>;

struct TimeSpan {
  std::int64_t begin_ns = 0;
  std::int64_t end_ns = 0;  ///< inclusive
};

/// begin, begin + 1 / rate, ... up to end.
StampList regular_stamps(std::int64_t begin_ns, std::int64_t end_ns, double rate_hz);

StampList stamps_within(const StampList& stamps, TimeSpan span);

/// The first of the grid's stamps in the span and then, for each further period, the nearest one:
/// a camera that is triggered by the clock of another sensor.
StampList stamps_nearest_to_period(const StampList& grid, TimeSpan span, std::int64_t period_ns);

// Light that changes during a flight: the overall brightness drifts slowly, and now and then a
// stretch of a few seconds is dark, as where lamps are out or an exposure control lags behind. A
// factor on the grey levels before the sensor's noise, so that dark pictures are noisy ones. Left
// out: lamps that move, flicker, overexposure that blooms.

class Illumination {
 public:
  static constexpr double kDrift = 0.25;     ///< largest drift of the brightness from 1
  static constexpr double kDarkEveryS = 25;  ///< one dark stretch in each period of this length
  static constexpr double kDarkGain = 0.3;   ///< factor within a dark stretch
  static constexpr double kDarkS = 3;        ///< its length, with ramps of kRampS at both ends
  static constexpr double kRampS = 0.5;

  explicit Illumination(std::uint64_t seed);
  /// Factor on the grey levels at a time of the flight, from 0.225 to 1.25.
  double gain(double t_s) const;

 private:
  /// 1 within the dark stretch of the period of time t, 0 outside, a smooth ramp between.
  double darkness(double t_s) const;

  std::uint64_t seed_;
  std::array<double, 2> phases_;
};

}  // namespace leviosim::traces
