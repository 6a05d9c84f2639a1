#include "tools/app/run/flight_cache.h"

#include <fcntl.h>

#include <fmt/core.h>

#include <chrono>

#include "sim/base/error.h"
#include "sim/base/interruption.h"
#include "sim/outputs/growing_file.h"
#include "sim/outputs/output_record.h"
#include "tools/app/cli/cache_folder.h"
#include "tools/app/cli/version.h"

namespace leviosim::tools {
namespace {

namespace fs = std::filesystem;

/// Excludes other processes while the result lives. The file stays; it is empty.
outputs::Descriptor locked(const fs::path& file) {
  constexpr std::chrono::hours kPatience{24};
  int error = 0;
  outputs::Descriptor lock =
      outputs::open_locked(file, O_CREAT | O_RDWR | O_NOFOLLOW, kPatience, error);
  if (!lock)
    throw InputError(
        fmt::format("{}: cannot be written: {}", file.string(), outputs::reason(error)));
  return lock;
}

/// Whether all files of the flight are there as they were drawn.
bool is_whole(const fs::path& folder) {
  const std::optional<outputs::OutputRecord> record = outputs::OutputRecord::read(folder);
  return record && !record->paths().empty() && record->is_complete(folder);
}

/// The name of the synthetic flight.
std::string synthetic_name() {
  return fmt::format("synthetic-{}-{:g}s-{}", kFlightSeed, kFlightSeconds,
                     flight_version().substr(0, 12));
}

/// Progress of drawing: "TITLE: image 3/60 · done in 0:00:12".
traces::FlightProgress shown_on(ProgressLine& line, const std::string& title) {
  return [&line, title](std::size_t done, std::size_t total) {
    throw_if_interrupted();
    const auto drawn = static_cast<std::int64_t>(done);
    const auto all = static_cast<std::int64_t>(total);
    line.show(drawn, all, [&] {
      return fmt::format("{}: image {}/{}{}", title, done, total,
                         time_left_text(drawn, all, line.host_seconds()));
    });
  };
}

}  // namespace

fs::path flight_folder() { return cache_folder() / synthetic_name(); }

void write_flight(const fs::path& folder, const traces::SyntheticOptions& options,
                  ProgressLine::Style progress) {
  ProgressLine line(progress);
  traces::write_synthetic_flight(folder, options, shown_on(line, "synthetic flight"));
}

void render_flight(const fs::path& motion, const fs::path& folder,
                   const traces::RenderedFlightOptions& options, const std::string& title,
                   ProgressLine::Style progress) {
  ProgressLine line(progress);
  traces::write_rendered_flight(motion, folder, options, shown_on(line, title));
}

fs::path cached_flight(const std::string& name, const std::function<void(const fs::path&)>& write) {
  const fs::path folder = cache_folder() / name;
  std::error_code error;
  fs::create_directories(folder.parent_path(), error);
  if (error)
    throw InputError(
        fmt::format("{}: cannot be created: {}", folder.parent_path().string(), error.message()));
  cache_folder();  // refuses it if it is not the user's
  const outputs::Descriptor lock = locked(folder.string() + ".lock");
  if (!is_whole(folder)) write(folder);
  return folder;
}

fs::path cached_flight(ProgressLine::Style progress) {
  return cached_flight(synthetic_name(), [&](const fs::path& folder) {
    traces::SyntheticOptions options;
    options.seed = kFlightSeed;
    options.duration_s = kFlightSeconds;
    options.repair = true;
    write_flight(folder, options, progress);
  });
}

}  // namespace leviosim::tools
