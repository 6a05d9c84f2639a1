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

#include <cstdint>
#include <filesystem>
#include <optional>
#include <vector>

#include "traces/datasets/asl_reader.h"
#include "traces/datasets/frame_range.h"
#include "traces/datasets/image_file.h"
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

}  // namespace leviosim::traces
