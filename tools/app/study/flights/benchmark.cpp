#include "tools/app/study/flights/benchmark.h"

#include <fmt/format.h>

#include <algorithm>
#include <functional>
#include <map>

#include "sim/base/error.h"
#include "sim/base/interruption.h"
#include "sim/base/printable.h"
#include "sim/base/sha256.h"
#include "tools/app/cli/host.h"
#include "tools/app/cli/version.h"
#include "tools/app/run/flight_cache.h"
#include "tools/app/study/flights/flight_pieces.h"
#include "tools/app/study/flights/flight_plan.h"
#include "tools/app/study/outcome_cache.h"
#include "traces/datasets/asl_reader.h"
#include "traces/recordings/recording.h"
#include "traces/synthesis/rendered_flight.h"

namespace leviosim::tools {
namespace {

namespace fs = std::filesystem;
using traces::FrameRange;

/// The IMU as it was recorded, so that the truth is, too.
traces::RenderedFlightOptions rendered_options(const FlightPlan& plan) {
  traces::RenderedFlightOptions options;
  options.prepared = plan.size;
  options.imu = traces::ImuSource::recorded;
  options.repair = true;
  return options;
}

/// Of the text files from which a flight is drawn, as one.
std::string digest_of_motion(const traces::MotionRecord& record) {
  traces::Dataset files;
  files.files = traces::asl_files(record.mav0);
  return digest_of(files);
}

FlightMotion open_one_motion(const FlightPlan& plan, const std::string& name,
                             const fs::path& folder) {
  const traces::MotionRecord record = traces::open_motion(folder);
  if (record.imu.empty())
    throw InputError(
        fmt::format("{}: there is no imu0/data.csv; a benchmark takes the IMU samples "
                    "that were recorded",
                    folder.string()));
  FlightMotion motion;
  motion.stamps_ns = traces::rendered_frame_stamps(record, rendered_options(plan));
  motion.sequence.name = name;
  motion.sequence.folder = folder.string();
  motion.sequence.inputs = digest_of_motion(record);
  motion.sequence.frames = motion.stamps_ns.size();
  motion.sequence.truth = traces::to_trajectory(record.ground_truth);
  motion.sequence.path_m =
      true_path_m(motion.sequence.truth, motion.stamps_ns.front(), motion.stamps_ns.back());
  motion.starts = starts_in_motion(motion.stamps_ns, motion.sequence.truth, plan.every_s);
  return motion;
}

FlightMotion open_one_recording(const FlightPlan& plan, const std::string& name,
                                const fs::path& folder) {
  FlightMotion motion;
  motion.recorded = true;
  motion.sequence = open_sequence({name, folder.string()}, std::nullopt, {plan.size});
  for (const traces::FrameRef& frame : traces::open_recording(folder).frames)
    motion.stamps_ns.push_back(frame.t_ns);
  return motion;
}

/// Where pieces begin that are no whole flights.
std::vector<std::size_t> starts_of(const FlightMotion& motion, const FlightSet& set) {
  if (!motion.recorded) return motion.starts.frames;
  std::vector<std::size_t> starts;
  for (std::size_t start = set.first; start < motion.stamps_ns.size(); start += set.step)
    starts.push_back(start);
  return starts;
}

/// The fewest frames of a piece that goes on to the end.
std::size_t shortest_rest(const FlightPlan& plan) {
  std::size_t longest = kFewestFrames - 1;
  for (const std::size_t length : plan.lengths)
    if (length != kRest) longest = std::max(longest, length);
  return longest + 1;
}

/// The ranges of frames of a length in a flight, and how many starts have none.
struct Ranges {
  std::vector<FrameRange> frames;
  std::size_t too_late = 0;
};

Ranges ranges_of(const FlightPlan& plan, const FlightMotion& motion, const FlightSet& set,
                 std::size_t length) {
  Ranges ranges;
  const std::size_t all = motion.stamps_ns.size();
  if (length == kWholeFlight) {
    ranges.frames.push_back({0, all});
    return ranges;
  }
  const std::size_t needed = length == kRest ? shortest_rest(plan) : length;
  for (const std::size_t start : starts_of(motion, set))
    if (needed <= all - start)
      ranges.frames.push_back({start, length == kRest ? all : start + length});
    else
      ++ranges.too_late;
  return ranges;
}

FlightPiece make_piece(const FlightMotion& motion, const FrameRange& frames) {
  FlightPiece piece;
  piece.frames = frames;
  const std::int64_t begin_ns = motion.stamps_ns[frames.begin];
  piece.start_s = static_cast<double>(begin_ns - motion.stamps_ns.front()) * 1e-9;
  piece.path_m = true_path_m(motion.sequence.truth, begin_ns, motion.stamps_ns[frames.end - 1]);
  return piece;
}

/// Those of a length, set and motion.
void add_pieces(Benchmark& benchmark, std::size_t length, std::size_t set, std::size_t motion) {
  const FlightPlan& plan = benchmark.plan;
  const FlightMotion& flight = benchmark.motions[motion];
  if (plan.sets[set].recorded() != flight.recorded) return;
  const Ranges ranges = ranges_of(plan, flight, plan.sets[set], length);
  // Starts of a motion are the same in all its sets.
  const auto same = [&](const FlightPiece& p) { return p.motion == motion && p.length == length; };
  if (flight.recorded || std::none_of(benchmark.pieces.begin(), benchmark.pieces.end(), same))
    benchmark.too_late += ranges.too_late;
  const std::vector<traces::Place> as_recorded{{.seed = 0}};
  for (const traces::Place& world : flight.recorded ? as_recorded : plan.sets[set].worlds)
    for (const FrameRange& frames : ranges.frames)
      for (std::size_t d = 0; d < plan.disturbances.size(); ++d) {
        FlightPiece& piece = benchmark.pieces.emplace_back(make_piece(flight, frames));
        piece.motion = motion;
        piece.set = set;
        piece.world = world;
        piece.disturbance = d;
        piece.length = length;
      }
}

/// What the pictures of a piece are made from, in place of their digests.
std::string pictures_of(const Benchmark& benchmark, const FlightPiece& piece) {
  const auto& [width, height] = benchmark.plan.size;
  const FlightMotion& motion = benchmark.motions[piece.motion];
  const traces::Disturbance& disturbance = benchmark.plan.disturbances[piece.disturbance];
  const std::string disturbed =
      disturbance.kind == nullptr ? "" : fmt::format(" disturbed {}", disturbance.text());
  if (motion.recorded)
    return fmt::format("{} frames {}:{}{}", motion.sequence.work, piece.frames.begin,
                       piece.frames.end, disturbed);
  return fmt::format("rendered {} world {} size {}x{} frames {}:{} by {}{}", motion.sequence.inputs,
                     piece.world.text(), width, height, piece.frames.begin, piece.frames.end,
                     flight_version(), disturbed);
}

/// "rendered/MH_01_easy-world-4-160x120-1a2b3c4d5e6f".
std::string name_in_cache(const Benchmark& benchmark, const DrawnFlight& flight) {
  const Sequence& sequence = benchmark.motions[flight.motion].sequence;
  const auto& [width, height] = benchmark.plan.size;
  std::string made_from = fmt::format("{} by {}", sequence.inputs, flight_version());
  for (const FrameRange& range : flight.frames)
    made_from += fmt::format(" {}:{}", range.begin, range.end);
  std::string world = flight.world.text();
  std::replace(world.begin(), world.end(), ':', '-');
  return fmt::format("rendered/{}-world-{}-{}x{}-{}", sequence.name, world, width, height,
                     base::sha256_of(made_from).substr(0, 12));
}

std::string draw(const Benchmark& benchmark, const DrawnFlight& flight,
                 const RunnerOptions& runner) {
  const Sequence& sequence = benchmark.motions[flight.motion].sequence;
  traces::RenderedFlightOptions options = rendered_options(benchmark.plan);
  options.place = flight.world;
  options.frames = flight.frames;
  options.threads = runner.threads;
  return cached_flight(name_in_cache(benchmark, flight),
                       [&](const fs::path& folder) {
                         render_flight(
                             sequence.folder, folder, options,
                             fmt::format("{}, world {}", sequence.name, flight.world.text()),
                             runner.progress);
                       })
      .string();
}

}  // namespace

Benchmark make_benchmark(FlightPlan plan, const std::string& folder) {
  Benchmark benchmark;
  benchmark.plan = std::move(plan);
  for (const std::string& name : benchmark.plan.motions) {
    throw_if_interrupted();
    benchmark.motions.push_back(open_one_motion(benchmark.plan, name, fs::path(folder) / name));
  }
  for (const std::string& name : benchmark.plan.recordings) {
    throw_if_interrupted();
    benchmark.motions.push_back(open_one_recording(benchmark.plan, name, fs::path(folder) / name));
  }
  for (const std::size_t length : benchmark.plan.lengths)
    for (std::size_t set = 0; set < benchmark.plan.sets.size(); ++set)
      for (std::size_t motion = 0; motion < benchmark.motions.size(); ++motion)
        add_pieces(benchmark, length, set, motion);
  if (benchmark.pieces.empty())
    throw InputError(
        fmt::format("{}: no piece begins in mid-air (motions: every {:g} s) and ends within its "
                    "flight; expected shorter pieces, or whole flights",
                    benchmark.plan.name, benchmark.plan.every_s));
  return benchmark;
}

std::size_t row_of(const Benchmark& benchmark, std::size_t variant, std::size_t piece) {
  return variant * benchmark.pieces.size() + piece;
}

std::vector<Point> benchmark_runs(const Benchmark& benchmark) {
  std::vector<Point> runs;
  const auto pictures = std::make_shared<traces::PictureMemory>();
  for (std::size_t v = 0; v < benchmark.plan.variants.size(); ++v)
    for (std::size_t p = 0; p < benchmark.pieces.size(); ++p)
      for (const std::uint32_t seed : benchmark.plan.seeds) {
        const FlightPiece& piece = benchmark.pieces[p];
        Point& run = runs.emplace_back();
        run.request.profile = benchmark.plan.variants[v].profile;
        run.request.workload = benchmark.plan.variants[v].workload;
        run.request.image_size = benchmark.plan.size;
        run.request.native = true;
        run.request.seed = seed;
        run.work = pictures_of(benchmark, piece);
        run.request.disturbance = benchmark.plan.disturbances[piece.disturbance];
        if (benchmark.motions[piece.motion].recorded) {
          run.request.data = benchmark.motions[piece.motion].sequence.folder;
          run.request.frames = piece.frames;
          run.request.pictures = pictures;
        }
        run.sequence = &benchmark.motions[piece.motion].sequence;
        run.row = row_of(benchmark, v, p);
      }
  return runs;
}

std::vector<DrawnFlight> drawn_flights(const Benchmark& benchmark) {
  std::map<std::pair<std::size_t, traces::Place>, std::vector<FrameRange>> all;
  for (const FlightPiece& piece : benchmark.pieces)
    if (!benchmark.motions[piece.motion].recorded)
      all[{piece.motion, piece.world}].push_back(piece.frames);
  std::vector<DrawnFlight> flights;
  for (auto& [of, ranges] : all)
    flights.push_back({of.first, of.second, merged(std::move(ranges))});
  return flights;
}

void draw_flights(const Benchmark& benchmark, const Measure& how, const RunnerOptions& options,
                  std::vector<Point>& runs) {
  const OutcomeCache cache(options.cache);
  const platform::Schema schema;
  const auto piece_of = [&](const Point& run) -> const FlightPiece& {
    return benchmark.pieces[run.row % benchmark.pieces.size()];
  };
  for (const DrawnFlight& flight : drawn_flights(benchmark)) {
    std::vector<Point*> open;
    for (Point& run : runs) {
      throw_if_interrupted();
      const FlightPiece& piece = piece_of(run);
      if (piece.motion == flight.motion && piece.world == flight.world &&
          !cache.find(run_key(run, how, schema)))
        open.push_back(&run);
    }
    if (open.empty()) continue;
    const std::string folder = draw(benchmark, flight, options);
    for (Point* run : open) {
      run->request.data = folder;
      run->request.frames = within(flight.frames, piece_of(*run).frames);
    }
  }
}

std::string list_text(const Benchmark& benchmark) {
  std::string text;
  for (const FlightPiece& piece : benchmark.pieces) {
    const FlightMotion& motion = benchmark.motions[piece.motion];
    const traces::Disturbance& disturbance = benchmark.plan.disturbances[piece.disturbance];
    text +=
        fmt::format("{}\t{}\t{}\t{}:{}\t{:.2f} s\t{:.2f} m{}\n",
                    printable(benchmark.plan.sets[piece.set].name), printable(motion.sequence.name),
                    motion.recorded ? "recorded" : fmt::format("world {}", piece.world.text()),
                    piece.frames.begin, piece.frames.end, piece.start_s, piece.path_m,
                    disturbance.kind == nullptr ? "" : "\t" + disturbance.text());
  }
  return text;
}

}  // namespace leviosim::tools
