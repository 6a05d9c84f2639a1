#include "tools/app/interactive/flight_data.h"

#include <fmt/format.h>

#include <array>
#include <map>
#include <span>
#include <string_view>
#include <vector>

#include "sim/base/error.h"
#include "tools/app/interactive/packing.h"
#include "tools/app/table/table_files.h"
#include "traces/trajectories/trajectory_alignment.h"
#include "workload/vio/frame_facts.h"

namespace leviosim::tools {
namespace {

using Name = std::string_view;
constexpr Name kStamp = "t_ns", kSource = "source";
constexpr std::array kFactColumns{kStamp,
                                  kSource,
                                  Name("keyframe"),
                                  Name("features"),
                                  Name("world_matches"),
                                  Name("inliers"),
                                  Name("landmarks"),
                                  Name("health"),
                                  Name("health_reasons")};
constexpr std::array kEstimate{"estimate_x_m", "estimate_y_m", "estimate_z_m"};

/// Some columns of a table of a run. @throws InputError for one that is missing, or of other things
Json columns_of(const RunFolder& run, const char* file, std::span<const Name> names) {
  Json all = columns_json(run.tables.at(file));
  Json columns = Json::object();
  for (const Name column : names) {
    const std::string name(column);
    if (!all.contains(name))
      throw InputError(fmt::format("{}/{}: has no column {}", run.record.name, file, name));
    for (const Json& value : all[name])
      if (!(name == kSource  ? value.is_string()
            : name == kStamp ? value.is_number_integer()
                             : value.is_number()))
        throw InputError(fmt::format("{}/{}: {} is not of the column {}", run.record.name, file,
                                     json_text(value), name));
    columns[name] = std::move(all[name]);
  }
  return columns;
}

/// The poses as they are, where there is no truth.
Json path_of(const traces::Trajectory& poses) {
  Json path;
  for (const traces::StampedPose& pose : poses) {
    path["t_ns"].push_back(pose.t_ns);
    for (std::size_t axis = 0; axis < kEstimate.size(); ++axis)
      path[kEstimate[axis]].push_back(rounded(pose.T_world_body.translation()[axis]));
  }
  return path;
}

/// Stamps become numbers of frames, and seconds since the first.
void number_frames(Json& path, const Json& stamps) {
  if (path.is_null()) return;
  std::map<std::int64_t, int> frames;
  for (const Json& stamp : stamps)
    frames.emplace(stamp.get<std::int64_t>(), static_cast<int>(frames.size()));
  Json numbers = Json::array(), seconds = Json::array();
  for (const Json& stamp : path.at("t_ns")) {
    const auto t_ns = stamp.get<std::int64_t>();
    const auto frame = frames.lower_bound(t_ns);
    numbers.push_back(frame == frames.end() ? static_cast<int>(frames.size()) - 1 : frame->second);
    seconds.push_back(static_cast<double>(t_ns - frames.begin()->first) * 1e-9);
  }
  path["frame"] = std::move(numbers);
  path["t_s"] = std::move(seconds);
  path.erase("t_ns");
}

/// What brings the map to where the path is drawn: nothing, if they leave that open.
traces::Similarity alignment_of(const traces::Trajectory& poses, const Json& path) {
  std::map<std::int64_t, Eigen::Vector3d> positions;
  for (const traces::StampedPose& pose : poses)
    positions.emplace(pose.t_ns, pose.T_world_body.translation());
  std::vector<Eigen::Vector3d> from, to;
  for (std::size_t i = 0; !path.is_null() && i < path.at("t_ns").size(); ++i) {
    const auto pose = positions.find(path.at("t_ns")[i].get<std::int64_t>());
    if (pose == positions.end()) continue;
    from.push_back(pose->second);
    Eigen::Vector3d& aligned = to.emplace_back();
    for (int axis = 0; axis < 3; ++axis)
      aligned[axis] = path.at(kEstimate[static_cast<std::size_t>(axis)])[i].get<double>();
  }
  try {
    return traces::align_points(from, to, traces::Alignment::sim3);
  } catch (const InputError&) {
    return {};
  }
}

/// Where the estimate was, beside the truth where there is one.
Json path_of(const RecordedRun& run) {
  if (!run.folder.tables.contains(kErrorsFile)) return path_of(run.poses);
  return columns_of(run.folder, kErrorsFile,
                    std::array{kStamp, Name(kEstimate[0]), Name(kEstimate[1]), Name(kEstimate[2]),
                               Name("truth_x_m"), Name("truth_y_m"), Name("position_error_m")});
}

void expect_frames(const RecordedRun& run, const char* file, std::size_t number) {
  const int frames = run.trace.frames();
  if (number != static_cast<std::size_t>(frames))
    throw InputError(fmt::format("{}/{}: has {} frames; expected {}, as {} has", run.name, file,
                                 number, frames, kWorkTraceFile));
}

/// For people: of poses, of the map and why it is not good.
Json words_json() {
  Json words{{"sources", Json::object()}};
  for (const vio::PoseSourceInfo& info : vio::kPoseSources)
    words["sources"][std::string(info.name)] = info.words;
  words["health"] = {{"names", vio::kHealthNames}, {"reasons", vio::kHealthReasons}};
  return words;
}

}  // namespace

Json flight_json(const RecordedRun& run) {
  Json facts = columns_of(run.folder, kFramesFile, kFactColumns);
  Json path = path_of(run);
  const Json stamps = facts.at("t_ns");
  expect_frames(run, kFramesFile, stamps.size());
  for (Json* table : {&path, &facts}) number_frames(*table, stamps);
  if (!path.is_null()) path.erase(kEstimate[2]);
  return {{"facts", std::move(facts)}, {"path", std::move(path)}, {"words", words_json()}};
}

std::string film_text(const RecordedRun& run) {
  if (run.film.empty()) return {};
  expect_frames(run, kFilmFile, run.film.size());
  const traces::Similarity to_path = alignment_of(run.poses, path_of(run));
  Json list = Json::array();
  for (const FilmFrame& frame : run.film) {
    Json features;
    for (std::size_t i = 0; i < kFeatureStates.size(); ++i)
      features[kFeatureStates[i]] = base64(frame.features[i]);
    Json points = Json::array();
    for (const auto& [x, y, z] : frame.points) {
      const Eigen::Vector3d metres =
          Eigen::Vector3d(static_cast<double>(x), static_cast<double>(y), static_cast<double>(z)) /
          1000;
      const Eigen::Vector3d aligned = to_path * metres;
      for (const double coordinate : {aligned.x(), aligned.y()})
        points.push_back(std::llround(1000 * coordinate));
    }
    list.push_back(
        {{"image", base64(frame.image)}, {"features", features}, {"points", std::move(points)}});
  }
  return json_text(list);
}

}  // namespace leviosim::tools
