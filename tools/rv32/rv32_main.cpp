// The scenes on RV32.
#include "tools/rv32/runtime.h"
#include RV32_SCENES

asm(".section .rodata\n"
    ".balign 4\n"
    "scene_inputs: .incbin \"" RV32_INPUTS
    "\"\n"
    ".text\n");
extern "C" const unsigned char scene_inputs[];

namespace {

/// One frame of the pipeline: source, keyframe, features, matches, landmarks.
void print(const leviosim::vio::FrameReport& report) {
  char text[80];
  int at = 0;
  const auto put = [&](int value) {
    char digits[12];
    int n = 0;
    do digits[n++] = static_cast<char>('0' + value % 10);
    while ((value /= 10) > 0);
    while (n > 0) text[at++] = digits[--n];
    text[at++] = ' ';
  };
  for (const int value :
       {static_cast<int>(report.source), report.keyframe ? 1 : 0, report.features,
        report.world_matches, report.frame_matches, report.inliers, report.landmarks})
    put(value);
  text[at - 1] = '\n';
  text[at] = 0;
  leviosim::rv32::write_text(text);
}

leviosim::rv32::Scenes<leviosim::work::Native>* all_scenes;

}  // namespace

int main() {
  using namespace leviosim;
  all_scenes = new rv32::Scenes<work::Native>(scene_inputs);
  all_scenes->run();
  for (const vio::FrameReport& report : all_scenes->reports()) print(report);
  return 0;
}
