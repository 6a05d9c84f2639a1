#include "tools/app/record/json_reader.h"

#include <fmt/format.h>

#include <utility>
#include <vector>

#include "sim/base/error.h"
#include "sim/base/interruption.h"

namespace leviosim::tools {
namespace {

/// Builds a document from what the parser finds, which does not call itself. Returns false to end.
class BoundedBuilder : public nlohmann::json_sax<Json> {
 public:
  explicit BoundedBuilder(const JsonLimits& limits) : limits_(limits) {}

  /// Why the text is refused; empty if it is not.
  const std::string& fault() const { return fault_; }
  Json take() { return std::move(document_); }

  bool null() override { return add(nullptr) != nullptr; }
  bool boolean(bool value) override { return add(value) != nullptr; }
  bool number_integer(number_integer_t value) override { return add(value) != nullptr; }
  bool number_unsigned(number_unsigned_t value) override { return add(value) != nullptr; }
  bool number_float(number_float_t value, const string_t&) override {
    return add(value) != nullptr;
  }
  bool string(string_t& value) override { return add(std::move(value)) != nullptr; }
  bool binary(binary_t&) override { return false; }
  bool start_object(std::size_t) override { return open(Json::object()); }
  bool start_array(std::size_t) override { return open(Json::array()); }
  bool key(string_t& name) override {
    name_ = std::move(name);
    return true;
  }
  bool end_object() override { return close(); }
  bool end_array() override { return close(); }
  bool parse_error(std::size_t position, const std::string&,
                   const nlohmann::detail::exception&) override {
    if (fault_.empty()) fault_ = fmt::format("no JSON document (byte {})", position);
    return false;
  }

 private:
  bool refuse(const char* what, std::size_t most) {
    fault_ = fmt::format("has more {} than {}", what, most);
    return false;
  }
  Json* add(Json value) {
    constexpr std::size_t kValuesPerPoll = 1024;
    if (++values_ > limits_.values) {
      refuse("values", limits_.values);
      return nullptr;
    }
    if (values_ % kValuesPerPoll == 0) throw_if_interrupted();
    if (open_.empty()) return &(document_ = std::move(value));
    Json& in = *open_.back();
    if (in.is_array()) {
      in.push_back(std::move(value));
      return &in.back();
    }
    add_member(in, name_, std::move(value));
    return &in.get_ref<Json::object_t&>().back().second;
  }
  bool open(Json empty) {
    if (open_.size() >= limits_.depth) return refuse("levels of arrays and objects", limits_.depth);
    Json* const added = add(std::move(empty));
    if (added == nullptr) return false;
    open_.push_back(added);  // stays where it is: what holds it grows only when it is closed
    return true;
  }
  bool close() {
    open_.pop_back();
    return true;
  }

  const JsonLimits& limits_;
  Json document_;
  std::vector<Json*> open_;
  std::string name_;
  std::size_t values_ = 0;
  std::string fault_;
};

/// @returns why it is refused; empty if it is not
std::string parse(std::string_view text, const JsonLimits& limits, Json& document) {
  if (text.size() > limits.bytes)
    return fmt::format("has {} bytes; expected at most {}", text.size(), limits.bytes);
  if (text.find('\0') != std::string_view::npos) return "no JSON document";  // taken for the end
  BoundedBuilder builder(limits);
  const bool is_whole = Json::sax_parse(text, &builder);
  if (!is_whole) return builder.fault().empty() ? "no JSON document" : builder.fault();
  document = builder.take();
  return document.is_object() ? std::string() : "no JSON document; expected {…}";
}

}  // namespace

Json read_json(const std::string& where, std::string_view text, const JsonLimits& limits) {
  Json document;
  const std::string fault = parse(text, limits, document);
  if (!fault.empty()) throw InputError(fmt::format("{}: {}", where, fault));
  return document;
}

std::optional<Json> try_read_json(std::string_view text, const JsonLimits& limits) {
  Json document;
  if (!parse(text, limits, document).empty()) return std::nullopt;
  return document;
}

}  // namespace leviosim::tools
