// The film of a run: small pictures of its frames with what became of their features, for pages
// that play a flight. A file of sections (traces/work_traces/section_file.h), one a frame, in which
// texts are lengths with bytes:
//
//   text     the image, as JPEG, at most 160 pixels wide
//   text     for each vio::FeatureState the features, 4 bytes each: x and y, and where the last
//            keyframe had it, all as 256ths of width and height; 2 for those without a match
//   count    of map points, then for each three signed whole numbers: x, y, z in the map's frame
//            [mm]; of keyframes alone
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "sim/base/units.h"
#include "sim/outputs/content.h"
#include "workload/vio/records.h"

namespace leviosim::tools {

/// In a run folder.
inline constexpr const char* kFilmFile = "flight.film";

/// By number of vio::FeatureState, in pages.
inline constexpr std::array<const char*, 5> kFeatureStates{"detected", "matched", "agrees",
                                                           "rejected", "new"};

/// Writes a film while the run goes on. An image gets the best quality with which it stays within
/// 2 kB, so 300 frames take less than 1.5 MB.
class FilmWriter {
 public:
  explicit FilmWriter(outputs::Sink sink);
  /// @param report  holds what was seen
  void add(const vio::FrameInput& input, const vio::FrameReport& report);
  /// So far.
  Bytes size() const { return size_; }

 private:
  void write(const std::string& bytes);

  outputs::Sink sink_;
  Bytes size_;
};

struct FilmFrame {
  std::string image;
  std::array<std::string, kFeatureStates.size()> features;
  std::vector<std::array<std::int64_t, 3>> points;  ///< [mm]
};

/// @param name    for messages
/// @param memory  that the film may take
/// @throws InputError for anything that is no whole film, naming the byte
std::vector<FilmFrame> film_of(const std::string& name, std::string_view bytes, Bytes memory);
/// The same of a file.
std::vector<FilmFrame> read_film(const std::filesystem::path& file, Bytes memory);

}  // namespace leviosim::tools
