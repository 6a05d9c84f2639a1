// Whether a text is well-formed XML, by a parser that is no work of ours.
#pragma once

#include <expat.h>

#include <memory>
#include <string>

namespace leviosim::tools::testing {

/// Empty if it is well-formed, else what is wrong and where.
inline std::string xml_fault(const std::string& text) {
  const std::unique_ptr<XML_ParserStruct, decltype(&XML_ParserFree)> parser(
      XML_ParserCreate(nullptr), &XML_ParserFree);
  if (XML_Parse(parser.get(), text.data(), static_cast<int>(text.size()), XML_TRUE) ==
      XML_STATUS_OK)
    return "";
  return "line " + std::to_string(XML_GetCurrentLineNumber(parser.get())) + ": " +
         XML_ErrorString(XML_GetErrorCode(parser.get()));
}

}  // namespace leviosim::tools::testing
