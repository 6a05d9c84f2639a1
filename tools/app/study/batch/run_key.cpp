#include "tools/app/study/batch/run_key.h"

#include <fmt/core.h>

#include <algorithm>

#include "platform_models/loader/loader.h"
#include "sim/base/sha256.h"
#include "tools/app/cli/version.h"

namespace leviosim::tools {

namespace {

/// What a run on a chip depends on beyond what a native one does.
std::string chip_key(const RunRequest& request) {
  std::string text =
      fmt::format("cores {}\n{}", request.cores, platform::to_yaml(request.platform));
  if (!request.camera) return text + "open loop\n";
  const auto& [fps, deadline] = *request.camera;
  return text + fmt::format("camera {} {}\n", fps ? fmt::format("{}", *fps) : "as recorded",
                            info_of(deadline).name);
}

}  // namespace

std::string run_key(const RunRequest& request, const std::string& inputs, const Measure& how) {
  std::string text = fmt::format("estimator {}\ninputs {}\nprofile {}\nseed {}\nsize {}x{}\n",
                                 results_version(), inputs, request.profile, request.seed,
                                 request.image_size.width, request.image_size.height);
  if (request.frames)
    text += fmt::format("frames {}:{}\n", request.frames->begin, request.frames->end);
  std::vector<std::string> settings;
  for (const vio::Assignment& a : request.workload) settings.push_back(a.text());
  std::sort(settings.begin(), settings.end());
  for (const std::string& setting : settings) text += fmt::format("set {}\n", setting);
  text += fmt::format("alignment {}\nlength {}\n", name_of(how.alignment), how.length_m);
  text += request.native ? std::string("native\n") : chip_key(request);
  return base::sha256_of(text);
}

}  // namespace leviosim::tools
