// Light that changes during a flight: the overall brightness drifts slowly, and now and then a
// stretch of a few seconds is dark, as where lamps are out or an exposure control lags behind. A
// factor on the grey levels before the sensor's noise, so that dark pictures are noisy ones. Left
// out: lamps that move, flicker, overexposure that blooms.
#pragma once

#include <array>
#include <cstdint>

namespace leviosim::traces {

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
