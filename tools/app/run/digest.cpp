#include "tools/app/run/digest.h"

#include <fmt/core.h>

#include "sim/base/input_file.h"
#include "sim/base/interruption.h"
#include "sim/base/sha256.h"

namespace leviosim::tools {

namespace fs = std::filesystem;

namespace {

InputDigest digest_of(std::string name, const std::vector<fs::path>& files, base::InputKind kind) {
  InputDigest digest;
  digest.name = std::move(name);
  base::Sha256 sha;
  for (const fs::path& file : files) {
    throw_if_interrupted();
    const std::string bytes = base::read_file(file, kind);
    sha.add(bytes);
    digest.bytes += static_cast<std::int64_t>(bytes.size());
  }
  digest.sha256 = sha.hex();
  return digest;
}

}  // namespace

InputDigest digest_of_file(const fs::path& file) {
  return digest_of(file.filename().string(), {file}, base::InputKind::work_trace);
}

std::vector<InputDigest> digest_inputs(const traces::Dataset& data) {
  std::vector<InputDigest> digests;
  for (const traces::InputFiles& input : data.files)
    digests.push_back(digest_of(input.name, input.files, base::InputKind::table));
  std::vector<fs::path> images;
  for (const traces::FrameRef& frame : data.frames) images.push_back(frame.path);
  digests.push_back(digest_of(fmt::format("{}, {} images concatenated", data.pictures, images.size()),
                              images, base::InputKind::image));
  return digests;
}

}  // namespace leviosim::tools
