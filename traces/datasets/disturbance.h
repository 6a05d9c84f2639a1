// What goes wrong with a recording, made while it is read: samples that are lost, late or off,
// pictures that are dark, noisy, covered or frozen, and a calibration that does not fit. One at a
// time, with one number: "noise=10". The same frames get the same disturbance, whatever the host.
// What happens for a while happens in the middle of the frames that were chosen. The truth stays as
// it is. Left out: rolling shutter, blur, faults that the reader refuses (gaps, stamps out of
// order).
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace leviosim::traces {

struct Dataset;
struct DisturbanceKind;

struct Disturbance {
  const DisturbanceKind* kind = nullptr;  ///< null: none
  double value = 0;                       ///< in the unit of the kind

  /// "none", or as it is parsed.
  std::string text() const;
};

/// "none" or KIND=VALUE. @throws InputError with the nearest kind, or the range of the value
Disturbance parse_disturbance(std::string_view text);

/// "noise [grey levels], dark [s], ...": what may be parsed.
std::string disturbance_kinds();

/// Disturbs frames, IMU samples and calibration, and marks the data set, so that an ImageSource
/// disturbs the pictures.
void disturb(Dataset& data, const Disturbance& disturbance);

/// What a picture's disturbance may depend on.
struct PictureTime {
  std::int64_t t_ns = 0;
  std::int64_t begin_ns = 0;  ///< of the first frame
  std::int64_t end_ns = 0;    ///< of the last frame
};

/// Disturbs a prepared picture of rows without padding.
void disturb_picture(const Disturbance& disturbance, const PictureTime& time, int width,
                     std::vector<std::uint8_t>& pixels);

}  // namespace leviosim::traces
