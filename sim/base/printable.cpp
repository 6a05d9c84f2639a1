#include "sim/base/printable.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <iterator>

namespace leviosim {
namespace {

struct Character {
  std::uint32_t code = 0;
  std::size_t length = 1;  ///< in bytes
  bool valid = false;      ///< UTF-8
};

std::uint8_t byte_at(std::string_view text, std::size_t i) {
  return static_cast<std::uint8_t>(text[i]);
}

/// The character that `text` begins with, decoded as RFC 3629 says.
Character first_character(std::string_view text) {
  const std::uint8_t lead = byte_at(text, 0);
  if (lead < 0x80u) return {lead, 1, true};
  constexpr std::array<std::uint32_t, 5> kLeast{0, 0, 0x80, 0x800, 0x10000};
  const std::size_t length = lead >= 0xF0u ? 4 : lead >= 0xE0u ? 3 : 2;
  if (lead < 0xC0u || lead >= 0xF8u || text.size() < length) return {};
  std::uint32_t code = lead & (0xFFu >> (length + 1));
  for (std::size_t i = 1; i < length; ++i) {
    const std::uint8_t next = byte_at(text, i);
    if ((next & 0xC0u) != 0x80u) return {};
    code = code << 6 | (next & 0x3Fu);
  }
  const bool surrogate = code >= 0xD800u && code <= 0xDFFFu;
  if (code < kLeast[length] || code > 0x10FFFFu || surrogate) return {};
  return {code, length, true};
}

struct CodeRange {
  std::uint32_t first, last;
};

constexpr std::array kEscaped{
    CodeRange{0x00, 0x1F},      // C0
    CodeRange{0x7F, 0x9F},      // DEL, C1
    CodeRange{0x2028, 0x2029},  // separators of lines and paragraphs
    CodeRange{0x202A, 0x202E},  // embeddings and overrides of the direction
    CodeRange{0x2066, 0x2069},  // isolates of the direction
    CodeRange{0xFFFE, 0xFFFF},  // no characters, which XML refuses
};

bool is_escaped(const Character& c) {
  if (!c.valid) return true;
  for (const CodeRange& range : kEscaped)
    if (c.code >= range.first && c.code <= range.last) return true;
  return false;
}

void append_escaped(std::string& out, std::string_view bytes) {
  for (std::size_t i = 0; i < bytes.size(); ++i) {
    if (bytes[i] == '\n')
      out += "\\n";
    else if (bytes[i] == '\t')
      out += "\\t";
    else if (bytes[i] == '\r')
      out += "\\r";
    else
      fmt::format_to(std::back_inserter(out), "\\x{:02x}", byte_at(bytes, i));
  }
}

/// Nothing but blanks since the last line break, and what may be a blank beyond ASCII.
bool begins_line(std::string_view text) {
  for (; !text.empty() && text.back() != '\n'; text.remove_suffix(1))
    if (text.back() > ' ' && text.back() < '\x7f') return false;
  return true;
}

/// Whether `next` would make a command of CI servers of what is printed: "::error::", "##[error]",
/// "##vso[task.complete]".
bool makes_command(const std::string& printed, char next) {
  const bool is_letter = (next >= 'a' && next <= 'z') || (next >= 'A' && next <= 'Z');
  if (is_letter || next == '[') return printed.ends_with("##");
  return next == ':' && printed.ends_with(':') &&
         begins_line(std::string_view(printed).substr(0, printed.size() - 1));
}

std::string escaped(std::string_view text, std::string_view kept) {
  std::string out;
  out.reserve(text.size());
  while (!text.empty()) {
    const Character c = first_character(text);
    const std::string_view bytes = text.substr(0, c.length);
    if (makes_command(out, bytes[0])) out += ' ';
    if (!is_escaped(c) || kept.find(bytes) != std::string_view::npos)
      out += bytes;
    else
      append_escaped(out, bytes);
    text.remove_prefix(c.length);
  }
  return out;
}

}  // namespace

std::string printable(std::string_view text) { return escaped(text, ""); }

std::string printable_json(std::string_view text) {
  constexpr std::uint8_t kFirstBeyond = 0x7f;
  const auto is_beyond = [](char c) { return static_cast<std::uint8_t>(c) >= kFirstBeyond; };
  if (std::none_of(text.begin(), text.end(), is_beyond)) return std::string(text);
  std::string out;
  out.reserve(text.size());
  while (!text.empty()) {
    const Character c = first_character(text);
    if (is_beyond(text[0]) && c.valid && is_escaped(c))
      fmt::format_to(std::back_inserter(out), "\\u{:04x}", c.code);
    else
      out += text.substr(0, c.length);
    text.remove_prefix(c.length);
  }
  return out;
}

std::string printable_lines(std::string_view text) { return escaped(text, "\n\t"); }

std::string shell_word(std::string_view word) {
  constexpr const char* kPlain =
      "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_-+./:=,@%";
  const std::string plain = printable(word);
  if (!plain.empty() && plain.find_first_not_of(kPlain) == std::string::npos) return plain;
  std::string text = "'";
  for (const char c : plain) text += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return text + "'";
}

}  // namespace leviosim
