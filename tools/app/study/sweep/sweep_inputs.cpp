#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <set>

#include "platform_models/loader/instruction_set.h"
#include "sim/base/check.h"
#include "sim/base/error.h"
#include "sim/base/input_file.h"
#include "sim/base/sha256.h"
#include "sim/base/text.h"
#include "tools/app/cli/command_line.h"
#include "tools/app/run/flight_cache.h"
#include "tools/app/run/run_folder.h"
#include "tools/app/run/run_request.h"
#include "tools/app/run/workload.h"
#include "tools/app/study/engine.h"
#include "tools/app/study/sweep/points.h"
#include "tools/app/study/sweep/sweep_store.h"
#include "traces/recordings/recording.h"

namespace leviosim::tools {
namespace {

using Kind = SweepKey::Kind;

constexpr std::string_view kChipPrefix = "platform.";

struct Word {
  std::string_view name;
  Kind kind;
};
constexpr std::array kWords{Word{"platform", Kind::platform}, Word{"profile", Kind::profile},
                            Word{"data", Kind::data},         Word{"trace", Kind::trace},
                            Word{"seed", Kind::seed},         Word{"size", Kind::size},
                            Word{"frames", Kind::frames},     Word{"cores", Kind::cores}};

std::vector<std::string> all_names(const platform::Schema& schema) {
  std::vector<std::string> names;
  for (const Word& word : kWords) names.emplace_back(word.name);
  for (const vio::Parameter& p : vio::parameters()) names.emplace_back(p.name);
  for (const std::string& path : schema.paths()) names.push_back(std::string(kChipPrefix) + path);
  return names;
}

const platform::Field& field_of(const SweepKey& key, const platform::Schema& schema) {
  return schema.fields()[schema.find(key.path)];
}

/// The unit that the chip's file gives the parameter, else the base unit.
std::string reference_unit(const SweepKey& key, platform::PlatformFile& reference) {
  const platform::Parameter* const known = reference.find(key.path);
  if (known != nullptr) return known->unit;
  return std::string(field_of(key, reference.schema()).dimension->units[0].name);
}

platform::Setting read_chip_value(const SweepKey& key, std::string_view text,
                                  platform::PlatformFile& reference, const platform::Place& place) {
  const platform::Field& field = field_of(key, reference.schema());
  if (field.is_choice()) return platform::read_value(field, text, "", place);
  const std::optional<platform::Measure> measure = platform::split_measure(text);
  if (!measure || measure->unit.empty())
    return platform::read_value(field, text, reference_unit(key, reference), place);
  const std::string_view number =
      platform::trim(text.substr(0, text.size() - measure->unit.size()));
  return platform::read_value(field, number, measure->unit, place);
}

std::int64_t most_of(Kind kind) {
  return kind == Kind::seed ? std::numeric_limits<std::uint32_t>::max()
                            : std::numeric_limits<int>::max();
}

using platform::Place;
using platform::YamlEntry;

constexpr double kMostSteps = 1e6;

double to_digits(double value, int digits) {
  return platform::parse_number(fmt::format("{:.{}g}", value, digits)).value_or(value);
}

bool is_whole(const SweepKey& key, const platform::Schema& schema) {
  if (key.kind == SweepKey::Kind::chip)
    return schema.fields()[schema.find(key.path)].dimension->whole;
  return key.parameter == nullptr || key.parameter->kind != vio::Parameter::Kind::number;
}

class RangeReader {
 public:
  RangeReader(const SweepKey& key, YamlMap map, platform::PlatformFile& reference)
      : key_(key), map_(std::move(map)), reference_(reference) {}

  Domain read(const Place& place) const {
    if (!key_.is_number(reference_.schema()))
      place.fail("has no range, as it is no number; expected a list of values");
    map_.check_keys({"from", "to", "step", "scale"});
    const SweepNumber low = number("from", place);
    const SweepNumber high = number("to", place);
    if (!(low.value < high.value)) place.fail("expected from below to");
    const YamlEntry* step = map_.find("step");
    const YamlEntry* scale = map_.find("scale");
    if (step != nullptr && scale != nullptr) place.fail("has step and scale; expected one of them");
    if (step != nullptr) return steps(low, high, *step);
    return {{},
            Span{low.value, high.value, is_logarithmic(scale, low, place),
                 is_whole(key_, reference_.schema()), low.factor, low.unit}};
  }

 private:
  SweepNumber number(const char* name, const Place& at) const {
    const YamlEntry* entry = map_.find(name);
    if (entry == nullptr) at.fail(fmt::format("missing key '{}'", name));
    return number_of(key_, map_.text(*entry), reference_, map_.place(*entry));
  }
  bool is_logarithmic(const YamlEntry* scale, const SweepNumber& low, const Place& at) const {
    if (scale == nullptr) return false;
    const std::string text = map_.text(*scale);
    if (text != "log" && text != "linear")
      map_.place(*scale).fail(fmt::format("'{}' is not known; expected linear or log", text));
    if (text == "log" && !(low.value > 0)) at.fail("a log scale begins above 0");
    return text == "log";
  }
  /// A step has the unit of the range; it may be smaller than any valid value.
  double step_size(const YamlEntry& entry, const SweepNumber& low) const {
    const Place at = map_.place(entry);
    const std::string text = map_.text(entry);
    const std::optional<platform::Measure> measure = platform::split_measure(text);
    if (!measure || !(measure->number > 0)) at.fail(fmt::format("'{}' is no number above 0", text));
    if (measure->unit.empty() || measure->unit == low.unit) return measure->number;
    const platform::Schema& schema = reference_.schema();
    const platform::Unit* unit =
        key_.kind == SweepKey::Kind::chip
            ? schema.fields()[schema.find(key_.path)].dimension->find(measure->unit)
            : nullptr;
    if (unit == nullptr) at.fail(fmt::format("'{}' is no unit of {}", measure->unit, key_.name));
    return measure->number * unit->factor / low.factor;
  }
  Domain steps(const SweepNumber& low, const SweepNumber& high, const YamlEntry& entry) const {
    const double step = step_size(entry, low);
    constexpr double kRounding = 1e-9;
    const double count = std::floor((high.value - low.value) / step + kRounding) + 1;
    if (count > kMostSteps)
      map_.place(entry).fail(
          fmt::format("gives {:g} values; expected at most {:g}", count, kMostSteps));
    Domain domain;
    for (int k = 0; k < static_cast<int>(count); ++k) {
      SweepNumber value = low;
      value.value = to_digits(low.value + k * step, 12);
      domain.values.push_back(normal_value(key_, value.text(), reference_, map_.place(entry)));
    }
    return domain;
  }

  const SweepKey& key_;
  YamlMap map_;
  platform::PlatformFile& reference_;
};

namespace fs = std::filesystem;

bool is_regular(const fs::path& file) {
  const std::optional<struct stat> status = outputs::status_of(file);
  return status && S_ISREG(status->st_mode);
}

[[noreturn]] void refuse(const SweepFolder::Request& request, const std::string& why) {
  throw InputError(fmt::format("{} {}: {}", request.option, request.path, why));
}

}  // namespace

bool SweepKey::is_number(const platform::Schema& schema) const {
  switch (kind) {
    case Kind::chip:
      return !field_of(*this, schema).is_choice();
    case Kind::workload:
      return parameter->kind != vio::Parameter::Kind::toggle;
    case Kind::seed:
    case Kind::cores:
      return true;
    default:
      return false;
  }
}

bool SweepKey::belongs_to_recording() const {
  return kind == Kind::workload || kind == Kind::profile || kind == Kind::data ||
         kind == Kind::seed || kind == Kind::size || kind == Kind::frames;
}

SweepKey find_key(const std::string& name, const platform::Schema& schema,
                  const platform::Place& place) {
  for (const Word& word : kWords)
    if (word.name == name) return {word.kind, name};
  if (const vio::Parameter* parameter = vio::find_parameter(name))
    return {Kind::workload, name, {}, parameter};
  if (name.starts_with(kChipPrefix)) {
    const std::string path = name.substr(kChipPrefix.size());
    if (path == platform::kBasePath) return {Kind::instruction_set, name, path};
    if (schema.find(path) != platform::Schema::kNone) return {Kind::chip, name, path};
  }
  place.fail("unknown key" + base::did_you_mean(name, all_names(schema)));
}

std::string SweepNumber::text() const { return platform::number_text(value) + unit; }

SweepNumber chip_number(const SweepKey& key, double base, platform::PlatformFile& reference) {
  const std::string unit = reference_unit(key, reference);
  const double factor = field_of(key, reference.schema()).dimension->find(unit)->factor;
  return {base / factor, factor, unit};
}

SweepNumber number_of(const SweepKey& key, const std::string& text,
                      platform::PlatformFile& reference, const platform::Place& place) {
  if (key.kind == Kind::chip)
    return chip_number(key, read_chip_value(key, text, reference, place).base, reference);
  if (key.kind == Kind::workload)
    return {parse_workload_value(place.where, *key.parameter, text), 1, {}};
  SweepNumber number;
  read_at(place, [&] {
    number.value = static_cast<double>(
        parse_whole(key.name, text, key.kind == Kind::cores ? 1 : 0, most_of(key.kind)));
  });
  return number;
}

std::string normal_value(const SweepKey& key, const std::string& text,
                         platform::PlatformFile& reference, const platform::Place& place) {
  const std::string value(platform::trim(text));
  if (value.empty()) place.fail("is empty; expected a value");
  switch (key.kind) {
    case Kind::chip: {
      const platform::Setting setting = read_chip_value(key, value, reference, place);
      if (field_of(key, reference.schema()).is_choice()) return setting.parameter.value;
      return chip_number(key, setting.base, reference).text();
    }
    case Kind::workload:
      return vio::value_text(*key.parameter,
                             parse_workload_value(place.where, *key.parameter, value));
    case Kind::seed:
    case Kind::cores:
      return number_of(key, value, reference, place).text();
    case Kind::profile:
      read_at(place, [&] { vio::expect_profile(value); });
      return value;
    case Kind::size:
      read_at(place, [&] { parse_size(value); });
      return value;
    case Kind::frames:
      read_at(place, [&] { traces::parse_frame_range(value); });
      return value;
    default:
      return value;  // names of files: checked when they are opened
  }
}

Domain read_domain(const SweepKey& key, const YamlMap& map, const YamlMap::Entry& entry,
                   platform::PlatformFile& reference) {
  const Place place = map.place(entry);
  const platform::YamlNode& node = entry.value;
  if (node.is_mapping()) return RangeReader(key, map.below(entry), reference).read(place);
  Domain domain;
  const auto add = [&](const platform::YamlNode& value) {
    domain.values.push_back(normal_value(key, platform::scalar(value, place), reference, place));
  };
  if (!node.is_sequence()) {
    add(node);
    return domain;
  }
  for (const platform::YamlNode& value : node.items()) add(value);
  if (domain.values.empty()) place.fail("is an empty list; expected values");
  return domain;
}

std::string value_at(const Domain& domain, double u) {
  check(u >= 0 && u < 1, "a place in a domain");
  if (!domain.span) {
    const auto count = static_cast<double>(domain.values.size());
    return domain.values[static_cast<std::size_t>(u * count)];
  }
  const Span& span = *domain.span;
  const auto at = [&](double low, double high) {
    return span.logarithmic ? low * std::pow(high / low, u) : low + (high - low) * u;
  };
  double value = 0;
  if (span.whole && span.factor == 1) {  // counts: each as likely as the other
    value = std::clamp(std::floor(at(span.low, span.high + 1)), span.low, span.high);
  } else {
    value = std::clamp(to_digits(at(span.low, span.high), 4), span.low, span.high);
    if (span.whole) value = std::round(value * span.factor) / span.factor;
  }
  return platform::number_text(value) + span.unit;
}

std::filesystem::path SweepInputs::beside(const std::string& name) const {
  return (folder_ / name).lexically_normal();  // an absolute name stays what it is
}

platform::PlatformFile& SweepInputs::platform(const std::string& name,
                                              const platform::Place& place) {
  const auto known = platforms_.find(name);
  if (known != platforms_.end()) return known->second;
  return read_at(place, [&]() -> std::reference_wrapper<platform::PlatformFile> {
    platform::PlatformFile file = platform::PlatformFile::named(name, folder_);
    file.resolve({});  // refuses what is wrong with the file itself
    return platforms_.emplace(name, std::move(file)).first->second;
  });
}

SweepInputs::Trace& SweepInputs::trace(const std::string& name, const platform::Place& place) {
  const auto known = traces_.find(name);
  if (known != traces_.end()) return known->second;
  return read_at(place, [&]() -> std::reference_wrapper<Trace> {
    std::filesystem::path file = beside(name);
    if (base::is_folder(file)) file /= kWorkTraceFile;
    // Called as in the plan: what a point says must not depend on where the plan lies.
    return keep_trace(name, traces::work_trace_bytes(file, memory_));
  });
}

SweepInputs::Trace& SweepInputs::keep_trace(const std::string& name, std::string bytes) {
  const std::string digest = base::sha256_of(bytes);
  auto work = std::make_unique<traces::WorkTrace>(name, std::move(bytes), memory_);
  platform::PlatformFile chip(name + ", platform of the recording", work->info().platform_yaml);
  return traces_.emplace(name, Trace{std::move(work), digest, std::move(chip)}).first->second;
}

const SweepInputs::Data& SweepInputs::data(const std::string& name, const std::string& frames,
                                           const platform::Place& place) {
  const auto key = std::make_pair(name, frames);
  const auto known = data_.find(key);
  if (known != data_.end()) return known->second;
  return read_at(place, [&]() -> std::reference_wrapper<const Data> {
    const std::filesystem::path folder =
        name == "synthetic" ? cached_flight(progress_) : beside(name);
    std::optional<traces::FrameRange> range;
    if (!frames.empty()) range = traces::parse_frame_range(frames);
    const traces::Dataset data = traces::open_recording(folder, {.frames = range});
    return data_.emplace(key, Data{folder.string(), work_of(data, digest_of(data)), data.camera})
        .first->second;
  });
}

SweepFolder::SweepFolder(const Request& request) {
  std::error_code error;
  path_ = outputs::resolved(request.path, error);
  if (error) refuse(request, "cannot be used: " + error.message());
  refuse_old_sweep(path_);
  const std::optional<struct stat> status = outputs::status_of(path_);
  if (status && S_ISLNK(status->st_mode)) refuse(request, "is a symbolic link that leads nowhere");
  if (status && !S_ISDIR(status->st_mode)) refuse(request, "is a file; expected a folder");
  const auto names = status ? outputs::names_in(path_) : std::set<std::string>();
  if (!names) refuse(request, "cannot be listed");
  for (const fs::path& input : request.inputs)
    if (status && outputs::lies_in(input, path_))
      refuse(request,
             fmt::format("holds {}, which is read; choose another folder", input.string()));
  for (const std::string& name : *names) check_entry(request, name);
  fs::create_directories(path_, error);
  if (error) refuse(request, "cannot be created: " + error.message());
  csv_.emplace(outputs::OutputRequest{.option = request.option,
                                      .path = (fs::path(request.path) / kSweepCsv).string(),
                                      .replace = true});
  if (!is_regular(path_ / kSweepFile)) outputs::add_to_record(path_, kSweepFile, {});
}

void SweepFolder::check_entry(const Request& request, const std::string& name) const {
  const auto foreign = [&] {
    refuse(request, fmt::format("exists and holds something other than a sweep: {}; choose a new "
                                "folder",
                                name));
  };
  if (!outputs::status_of(path_ / name)) return;  // of another process, and gone by now
  std::error_code error;
  if (fs::equivalent(path_ / name, request.cache, error)) return;
  // Its OutputFile looks at these.
  if (name == outputs::StagingFolder::place_of(path_ / kSweepCsv).filename()) return;
  if (!is_regular(path_ / name)) foreign();
  if (name == outputs::kRecordName || name == kSweepCsv) return;
  if (name == kSweepFile) {
    if (!is_sweep(path_)) foreign();
    return;
  }
  // Such as a page that was asked for here. In the folder of a run, all is of the run.
  const std::optional<outputs::OutputRecord> record = outputs::OutputRecord::read(path_);
  if (!record || !record->names(kSweepFile) || !record->describes(path_, name)) foreign();
}

void SweepFolder::empty() {
  if (!is_regular(path_ / kSweepFile)) return;
  if (::unlink((path_ / kSweepFile).c_str()) != 0)
    throw InputError(fmt::format("{}: cannot be removed: {}", (path_ / kSweepFile).string(),
                                 outputs::reason(errno)));
}

}  // namespace leviosim::tools
