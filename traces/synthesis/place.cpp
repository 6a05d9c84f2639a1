#include "traces/synthesis/place.h"

#include <fmt/format.h>

#include <charconv>
#include <limits>
#include <string_view>

#include "sim/base/csv.h"
#include "sim/base/error.h"
#include "sim/base/nearest.h"

namespace leviosim::traces {
namespace {

constexpr double kNearestM = 0.2;
constexpr double kFarthestM = 100;

bool parse_seed(std::string_view text, std::uint64_t& seed) {
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), seed);
  return error == std::errc() && end == text.data() + text.size() &&
         seed <= static_cast<std::uint64_t>(std::numeric_limits<std::int64_t>::max());
}

/// Of "0.3m".
bool parse_distance(std::string_view text, double& distance_m) {
  return text.ends_with('m') && base::parse_number(text.substr(0, text.size() - 1), distance_m) &&
         distance_m >= kNearestM && distance_m <= kFarthestM;
}

}  // namespace

std::string Place::text() const {
  if (kind == PlaceKind::hall) return fmt::format("{}", seed);
  if (kind == PlaceKind::workshop) return fmt::format("workshop:{}", seed);
  return fmt::format("{}m:{}", distance_m, seed);
}

Place parse_place(const std::string& what, const std::string& text) {
  const std::size_t colon = text.find(':');
  const std::string kind = colon == std::string::npos ? "hall" : text.substr(0, colon);
  Place place;
  if (kind == "workshop")
    place.kind = PlaceKind::workshop;
  else if (parse_distance(kind, place.distance_m))
    place.kind = PlaceKind::surround;
  else if (kind != "hall")
    throw InputError(fmt::format(
        "{} '{}': there is no kind of world '{}'{}; expected hall, workshop, or a distance from "
        "{:g}m to {:g}m",
        what, text, kind, base::did_you_mean(kind, {"hall", "workshop"}), kNearestM, kFarthestM));
  if (!parse_seed(std::string_view(text).substr(colon == std::string::npos ? 0 : colon + 1),
                  place.seed))
    throw InputError(fmt::format(
        "{} '{}': expected a whole number from 0, or one behind its kind, such as workshop:4", what,
        text));
  return place;
}

}  // namespace leviosim::traces
