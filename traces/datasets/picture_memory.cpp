#include "traces/datasets/picture_memory.h"

namespace leviosim::traces {

std::optional<PictureMemory::Pixels> PictureMemory::find(const std::string& name) const {
  const std::lock_guard guard(lock_);
  const auto it = pictures_.find(name);
  if (it == pictures_.end()) return std::nullopt;
  return it->second;
}

void PictureMemory::keep(const std::string& name, const Pixels& pixels) {
  const std::lock_guard guard(lock_);
  if (bytes_ + pixels.size() > most_ || !pictures_.emplace(name, pixels).second) return;
  bytes_ += pixels.size();
}

}  // namespace leviosim::traces
