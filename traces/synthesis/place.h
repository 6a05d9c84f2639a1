// What kind of place a rendered flight goes through, and which of its kind.
#pragma once

#include <compare>
#include <cstdint>
#include <string>

namespace leviosim::traces {

enum class PlaceKind {
  hall,      ///< walls, boxes and posters of high contrast, 0.8 m away or more: easy
  workshop,  ///< timber, nets, rails and cables, near before far, dark and glaring (hall.h)
  surround   ///< surfaces all around the path at one distance
};

struct Place {
  PlaceKind kind = PlaceKind::hall;
  std::uint64_t seed = 1;  ///< of layout, textures, light and noise
  double distance_m = 0;   ///< of a surround

  /// "4" for a hall, "workshop:4", "0.3m:4".
  std::string text() const;
  friend auto operator<=>(const Place&, const Place&) = default;
};

/// From its text. Distances are from 0.2 to 100 m.
/// @throws InputError that begins with `what`
Place parse_place(const std::string& what, const std::string& text);

}  // namespace leviosim::traces
