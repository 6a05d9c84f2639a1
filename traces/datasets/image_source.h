// The frames of a dataset as the pipeline sees them: read, checked and prepared.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "traces/datasets/camera_model.h"
#include "traces/datasets/dataset.h"
#include "traces/datasets/image_file.h"
#include "traces/datasets/image_preparation.h"
#include "traces/datasets/picture_memory.h"

namespace leviosim::traces {

/// 8-bit grey, row by row without padding.
struct GrayImage {
  int width = 0;
  int height = 0;
  std::vector<std::uint8_t> pixels;
  std::int64_t t_ns = 0;
};

/// Reads and prepares the frames of a dataset. Immutable after construction: read() is a pure
/// function of the frame's index and may be called from several threads.
class ImageSource {
 public:
  /// @param memory  of prepared pictures, shared with other sources; none: each is read again
  /// @throws InputError if the size does not fit
  ImageSource(const Dataset& data, ImageSize size, std::shared_ptr<PictureMemory> memory = {});

  std::size_t size() const { return frames_.size(); }
  const PinholeIntrinsics& intrinsics() const { return preparation_.intrinsics(); }

  /// The prepared image of frame i < size(). Throws InputError, naming image, file and line, if it
  /// cannot be decoded, has another size than sensor.yaml says, or is not 8-bit grey.
  GrayImage read(std::size_t i) const;
  /// The same as the camera took it, faulty pixels mended.
  std::vector<std::uint8_t> read_full(std::size_t i) const;

 private:
  std::vector<std::uint8_t> prepared(std::size_t i) const;

  std::filesystem::path frames_csv_;
  std::vector<FrameRef> frames_;
  ImageSize full_size_;
  PixelMending mending_;
  Disturbance disturbance_;
  ImagePreparation preparation_;
  std::shared_ptr<PictureMemory> memory_;
  std::string preparation_name_;  ///< of what is made of every picture
};

}  // namespace leviosim::traces
