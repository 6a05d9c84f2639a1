#include "tools/batch/run_key.h"

#include <fmt/core.h>

#include <algorithm>

#include "sim/check.h"
#include "tools/run/digest.h"

namespace leviosim::tools {

std::string run_key(const RunRequest& request, const std::string& inputs, const Measure& how) {
  check(request.native, "a run on a chip depends on the chip too");
  std::string text = fmt::format("estimator {}\ninputs {}\nprofile {}\nseed {}\nsize {}x{}\n",
                                 estimator_version(), inputs, request.profile, request.seed,
                                 request.image_size.width, request.image_size.height);
  if (request.frames)
    text += fmt::format("frames {}:{}\n", request.frames->begin, request.frames->end);
  std::vector<std::string> settings;
  for (const vio::Assignment& a : request.workload) settings.push_back(a.text());
  std::sort(settings.begin(), settings.end());
  for (const std::string& setting : settings) text += fmt::format("set {}\n", setting);
  text += fmt::format("alignment {}\nlength {}\n", name_of(how.alignment), how.length_m);
  Sha256 digest;
  digest.add(text);
  return digest.hex();
}

}  // namespace leviosim::tools
