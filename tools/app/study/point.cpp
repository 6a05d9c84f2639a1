#include "tools/app/study/point.h"

#include <fmt/core.h>

#include "platform_models/loader/platform_file.h"
#include "sim/base/input_file.h"
#include "sim/base/sha256.h"
#include "tools/app/cli/version.h"
#include "tools/app/run/run_folder.h"
#include "tools/app/run/workload.h"

namespace leviosim::tools {
namespace {

std::string workload_lines(const RunRequest& request) {
  std::string text = fmt::format("size {}x{}\nseed {}\nprofile {}\n", request.image_size.width,
                                 request.image_size.height, request.seed, request.profile);
  const std::vector<double> values = parameter_values(request);
  for (std::size_t i = 0; i < values.size(); ++i) {
    const vio::Parameter& parameter = vio::parameters()[i];
    text += fmt::format("{} {}\n", parameter.name, value_text(parameter, values[i]));
  }
  return text;
}

std::string chip_lines(const RunRequest& request, const platform::Schema& schema) {
  std::string text =
      fmt::format("cores {}\n", request.cores) + canonical_text(schema, request.platform);
  if (!request.camera) return text;
  const auto& [fps, deadline] = *request.camera;
  return text + fmt::format("camera {} {}\n", fps ? fmt::format("{}", *fps) : "as recorded",
                            info_of(deadline).name);
}

}  // namespace

std::string identity_of(const Point& point, const platform::Schema& schema) {
  std::string text = point.work + '\n';
  if (point.trace == nullptr) text += workload_lines(point.request);
  return text + (point.request.native ? "native\n" : chip_lines(point.request, schema));
}

std::string point_key(std::string_view kept, const std::string& identity) {
  return base::sha256_of(fmt::format("simulator {}\n{}\n{}", results_version(), kept, identity));
}

}  // namespace leviosim::tools
