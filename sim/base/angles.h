// Constants of angles.
#pragma once

namespace leviosim::base {

inline constexpr double kTwoPi = 6.283185307179586476925;
inline constexpr double kDegreesPerRadian = 57.295779513082320876798;

}  // namespace leviosim::base
