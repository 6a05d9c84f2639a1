// The scenes of another project, measured as ours are: RV32_KERNELS is a header with
//   template <class P> void scenes();
// which makes inputs, and then calls kernels within the life of a Function named "scene: …".
#pragma once

#include <vector>

#include RV32_KERNELS
#include "workload/vio/records.h"

namespace leviosim::rv32 {

template <class P>
class Scenes {
 public:
  explicit Scenes(const unsigned char*) {}
  void run() { scenes<P>(); }
  std::vector<vio::FrameReport> reports() const { return {}; }
};

}  // namespace leviosim::rv32
