// Grey pictures from the bytes of a PNG or JPEG file, by libraries that print nothing and say what
// is wrong. The head of the file is checked before memory is asked for. And PNG files of pictures.
// Colours become grey by the luma of Rec. 601, of 16 bits the upper 8 are kept (as TUM-VI is usually
// read), transparency is passed over. Left out: CMYK and other formats, which are refused; OpenCV's
// codecs, which load a hundred libraries when a program starts.
#pragma once

#include <opencv2/core.hpp>
#include <string>
#include <string_view>

namespace leviosim::traces {

/// The picture, 8-bit grey (CV_8UC1); PNG files of 1, 2 and 4 bits are scaled to 8. Throws
/// InputError, without the file's name, for anything else, another size than `expected`, and files
/// that are damaged or cut off.
cv::Mat decode_gray(std::string_view bytes, cv::Size expected);

/// What the head of the file says. Throws InputError as decode_gray() does.
cv::Size image_size(std::string_view bytes);

/// The bytes of a PNG file of a picture, 8-bit grey (CV_8UC1) and of a row at least; the same
/// pixels give the same bytes. Compressed lightly, for pictures with noise.
std::string encode_png(const cv::Mat& image);

}  // namespace leviosim::traces
