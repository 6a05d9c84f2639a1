// Bytes as text of a page: gzip, which browsers unpack (DecompressionStream), in base64.
#pragma once

#include <string>
#include <string_view>

namespace leviosim::tools {

/// Same bytes, same text.
std::string gzipped(std::string_view bytes);
std::string base64(std::string_view bytes);

}  // namespace leviosim::tools
