#include "tools/run/digest.h"

#include <fmt/core.h>
#include <openssl/evp.h>

#include <array>

#include "sim/base/interruption.h"
#include "sim/check.h"
#include "traces/csv.h"

namespace leviosim::tools {

namespace fs = std::filesystem;

struct Sha256::State {
  EVP_MD_CTX* context = EVP_MD_CTX_new();
  ~State() { EVP_MD_CTX_free(context); }
};

Sha256::Sha256() : state_(std::make_unique<State>()) {
  check(EVP_DigestInit_ex(state_->context, EVP_sha256(), nullptr) == 1, "SHA-256 begins");
}

Sha256::~Sha256() = default;

void Sha256::add(std::string_view bytes) {
  constexpr std::size_t kChunk = std::size_t{1} << 22;  // some milliseconds
  for (; bytes.size() > kChunk; bytes.remove_prefix(kChunk)) {
    throw_if_interrupted();
    check(EVP_DigestUpdate(state_->context, bytes.data(), kChunk) == 1, "SHA-256 goes on");
  }
  check(EVP_DigestUpdate(state_->context, bytes.data(), bytes.size()) == 1, "SHA-256 goes on");
}

std::string Sha256::hex() {
  std::array<unsigned char, EVP_MAX_MD_SIZE> digest{};
  unsigned size = 0;
  check(EVP_DigestFinal_ex(state_->context, digest.data(), &size) == 1, "SHA-256 ends");
  std::string text;
  for (unsigned i = 0; i < size; ++i) text += fmt::format("{:02x}", digest[i]);
  return text;
}

namespace {

InputDigest digest_of(std::string name, const std::vector<fs::path>& files) {
  InputDigest digest;
  digest.name = std::move(name);
  Sha256 sha;
  for (const fs::path& file : files) {
    throw_if_interrupted();
    const std::string bytes = traces::read_text_file(file);
    sha.add(bytes);
    digest.bytes += static_cast<std::int64_t>(bytes.size());
  }
  digest.sha256 = sha.hex();
  return digest;
}

}  // namespace

InputDigest digest_of_file(const fs::path& file) {
  return digest_of(file.filename().string(), {file});
}

std::vector<InputDigest> digest_inputs(const traces::Dataset& data) {
  const fs::path mav0 = data.frames_csv.parent_path().parent_path();
  std::vector<InputDigest> digests;
  for (const char* name : {"cam0/sensor.yaml", "cam0/data.csv", "imu0/sensor.yaml", "imu0/data.csv",
                           "state_groundtruth_estimate0/data.csv"})
    if (fs::exists(mav0 / name)) digests.push_back(digest_of(name, {mav0 / name}));
  std::vector<fs::path> images;
  for (const traces::FrameRef& frame : data.frames) images.push_back(frame.path);
  digests.push_back(
      digest_of(fmt::format("cam0/data, {} images concatenated", images.size()), images));
  return digests;
}

}  // namespace leviosim::tools
