// Text from outside (names of files, cells, values of YAML, traces) made fit for a terminal, a log
// or a JSON file: always valid UTF-8, never a control character. What is escaped can be read, but
// not turned back: a backslash stays as it is, since names and messages are full of them.
#pragma once

#include <string>
#include <string_view>

namespace leviosim {

/// One line of text. Escaped are control characters (C0, DEL, C1), the separators of lines and
/// paragraphs, the characters that change the direction of writing, U+FFFE, U+FFFF, and bytes that
/// are no UTF-8: "\n", "\t", "\r" and else "\x1b" for each byte. What servers of CI would obey gets
/// a blank: "::" where a line begins, and "##" before a letter or '['.
std::string printable(std::string_view text);
/// A text of JSON, in UTF-8, of which printable() would change no character: what it would escape,
/// and can stand in strings only, is written as JSON escapes it.
std::string printable_json(std::string_view text);

/// Printable form of a text of several lines, such as tables: newlines and tabs stay.
std::string printable_lines(std::string_view text);

/// Printable form of one word of a command line, in quotes where a shell would read it otherwise.
std::string shell_word(std::string_view word);

}  // namespace leviosim
