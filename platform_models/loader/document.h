// A platform file as text → its parameters. Strict: every key must be one of the schema's, every
// number must have a unit, a source and a confidence, and each fault is an InputError that says
// where it is.
//
// A parameter is one map, `workers: { value: 8, unit: cores, source: "…", confidence: high }`, and
// may have a `range: [low, high]` for sensitivity sweeps and a `note`. Rows of the operation tables
// have columns such as `issue`, `stall` and `on` in place of `value`, with ranges such as
// `issue_range`. The text of a source up to the first parenthesis is a list of keys of the file's
// section `sources`.
//
// `isa: { base: NAME }` takes the parameters of an instruction set (instruction_set.h), which is a
// file of the same format with the section `isa` only, and may have a base itself. A row that the
// file gives again replaces the row of the base as a whole.
//
// `extends: NAME` takes everything of another platform, sources included, and adds to it in the
// same way: a chip at another operating point, with an accelerator. Such a file names no
// instruction set, needs neither name nor description, and may give bare values, `workers: 16`,
// whose source is "what if".
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "platform_models/loader/parameter.h"
#include "platform_models/loader/schema.h"

namespace leviosim::platform {

/// Settings by index of the field in the schema; empty where the file says nothing.
using Settings = std::vector<std::optional<Setting>>;

struct Document {
  std::string name;                            ///< of the chip
  std::string description;                     ///< one line
  std::map<std::string, std::string> sources;  ///< what the keys in sources stand for
  Settings settings;
};

/// An instruction set to use in place of the one that the platform names.
struct BaseOverride {
  std::string base;
  std::string where;  ///< "-p isa.base=rv32imfc"
};

/// @param file  name of the file for messages
Document read_document(const Schema& schema, const std::string& file, const std::string& text,
                       const std::optional<BaseOverride>& base = {});

}  // namespace leviosim::platform
