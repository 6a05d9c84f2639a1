#include "tools/app/study/point.h"

#include <fmt/core.h>

#include "platform_models/loader/platform_file.h"
#include "sim/base/sha256.h"
#include "tools/app/cli/version.h"

namespace leviosim::tools {
namespace {

class Identity {
 public:
  std::vector<IdentityLine> of(const Point& point, const platform::Schema& schema) {
    add("", point.work + '\n');
    if (point.trace == nullptr) add_workload(point.request);
    if (point.request.native)
      add("", "native\n");
    else
      add_chip(point.request, schema);
    return std::move(lines_);
  }

 private:
  void add(std::string key, std::string text) {
    lines_.push_back({std::move(key), std::move(text)});
  }

  void add_workload(const RunRequest& request) {
    add("", fmt::format("size {}x{}\n", request.image_size.width, request.image_size.height));
    add("seed", fmt::format("seed {}\n", request.seed));
    add("", fmt::format("profile {}\n", request.profile));
    const vio::Profile profile = profile_of(request);
    for (const vio::Parameter& p : vio::parameters())
      add(std::string(p.name), fmt::format("{} {}\n", p.name, value_text(p, p.get(profile))));
  }

  void add_chip(const RunRequest& request, const platform::Schema& schema) {
    add("cores", fmt::format("cores {}\n", request.cores));
    for (const platform::CanonicalLine& line : canonical_lines(schema, request.platform))
      add(line.path.empty() ? "" : "platform." + line.path, line.text);
    if (!request.camera) return;
    const auto& [fps, deadline] = *request.camera;
    add("", fmt::format("camera {} {}\n", fps ? fmt::format("{}", *fps) : "as recorded",
                        info_of(deadline).name));
  }

  std::vector<IdentityLine> lines_;
};

}  // namespace

std::vector<IdentityLine> identity_of(const Point& point, const platform::Schema& schema) {
  return Identity().of(point, schema);
}

std::string text_of(const std::vector<IdentityLine>& identity) {
  std::string text;
  for (const IdentityLine& line : identity) text += line.text;
  return text;
}

std::string point_key(std::string_view kept, const std::string& identity) {
  return base::sha256_of(fmt::format("simulator {}\n{}\n{}", results_version(), kept, identity));
}

}  // namespace leviosim::tools
