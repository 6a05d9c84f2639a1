// Calls of libpng from C++. The library leaves a call at an error by a jump over all frames in
// between; here the jump ends in a plain result.
#pragma once

#include <png.h>
#include <zlib.h>

#include <csetjmp>
#include <new>
#include <string>

namespace leviosim::traces {

/// What libpng keeps of one file that is read or written.
class PngCalls {
 public:
  enum class Kind { Read, Write };

  /// @throws std::bad_alloc
  explicit PngCalls(Kind kind) : kind_(kind) {
    const auto create = kind == Kind::Read ? png_create_read_struct : png_create_write_struct;
    png_ = create(PNG_LIBPNG_VER_STRING, this, fail, ignore);
    if (png_ != nullptr) info_ = png_create_info_struct(png_);
    if (info_ == nullptr) {
      destroy();
      throw std::bad_alloc();
    }
  }
  ~PngCalls() { destroy(); }
  PngCalls(const PngCalls&) = delete;
  PngCalls& operator=(const PngCalls&) = delete;

  png_structp png() const { return png_; }
  png_infop info() const { return info_; }

  /// Whether `body` came to its end. An error of the library ends it where it is, so it must hold
  /// no object that has a destructor.
  template <class Body>
  bool succeed(const Body& body) {
    if (setjmp(png_jmpbuf(png_)) != 0) return false;
    body();
    return true;
  }
  /// Of the last error.
  const std::string& reason() const { return reason_; }

 private:
  [[noreturn]] static void fail(png_structp png, png_const_charp message) {
    static_cast<PngCalls*>(png_get_error_ptr(png))->reason_ = message;
    png_longjmp(png, 1);
  }
  static void ignore(png_structp, png_const_charp) {}
  void destroy() {
    if (kind_ == Kind::Read)
      png_destroy_read_struct(&png_, &info_, nullptr);
    else
      png_destroy_write_struct(&png_, &info_);
  }

  Kind kind_;
  png_structp png_ = nullptr;
  png_infop info_ = nullptr;
  std::string reason_;
};

}  // namespace leviosim::traces
